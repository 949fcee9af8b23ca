# The programs of kernels, each for work-items alone in their group and for groups of them: sets kernels, the files, and
# programs, what embed.cmake makes of them. Needs kernel_folder.
file(GLOB kernels CONFIGURE_DEPENDS ${kernel_folder}/*/*.cl ${kernel_folder}/*/*.h)
set(programs)
foreach(path structured/classify structured/emit snap/snap tetrahedra/complex tetrahedra/complex_caps
        tetrahedra/complex_interval labels/labels)
    get_filename_component(program ${path} NAME)
    list(APPEND programs ${program}_alone=${kernel_folder}/${path}.cl=1
         ${program}_groups=${kernel_folder}/${path}.cl=0)
endforeach()
# In both variants one text, that for groups.
list(APPEND programs interval_groups=${kernel_folder}/interval/interval.cl=0)
