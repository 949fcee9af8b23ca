# Sets plain_kernels: what POCL_EXTRA_BUILD_FLAGS tells PoCL so that it neither optimises kernels nor inlines functions,
# most of the time that a test takes. Empty where PoCL is of another version than 3: of those that are known, 6.0 aborts on kernels that are not
# optimised.
set(plain_kernels)
execute_process(COMMAND dpkg-query -W "-f=\${Version}" pocl-opencl-icd
                OUTPUT_VARIABLE pocl_version ERROR_QUIET RESULT_VARIABLE no_package)
if(NOT no_package AND pocl_version MATCHES "^3\\.")
    set(plain_kernels "-cl-opt-disable -Dinline_always=static")
endif()
