/*
 * entries.h - every entry point that the library uses, with its parameters, for code that is the same for all of them
 *
 * OPENCL_ENTRIES(S, O, E, M): each entry as one of
 *     S(name, parameters, arguments)         returns a status
 *     O(type, name, parameters, arguments)   returns an object, and leaves the status in *error
 *     E(name, blocks, parameters, arguments) puts a command into `queue`, hands out its `event`, returns a status;
 *                                            blocks: whether it returns when the command has ended
 *     M(type, name, parameters, arguments)   the one of these that returns memory, and leaves the status in *error
 */
#ifndef ENTRIES_H
#define ENTRIES_H

#define ENTRY_INFO  size_t bytes, void *value, size_t *bytes_ret
#define ENTRY_WAITS cl_uint wait_count, const cl_event *waits, cl_event *event

/* clang-format off */
#define OPENCL_ENTRIES(S, O, E, M)                                                                                     \
    S(GetPlatformIDs, (cl_uint room, cl_platform_id *platforms, cl_uint *count), (room, platforms, count))             \
    S(GetPlatformInfo, (cl_platform_id platform, cl_platform_info what, ENTRY_INFO),                                   \
      (platform, what, bytes, value, bytes_ret))                                                                       \
    S(GetDeviceIDs, (cl_platform_id platform, cl_device_type type, cl_uint room, cl_device_id *devices,                \
      cl_uint *count), (platform, type, room, devices, count))                                                         \
    S(GetDeviceInfo, (cl_device_id device, cl_device_info what, ENTRY_INFO), (device, what, bytes, value, bytes_ret))  \
    O(cl_context, CreateContext, (const cl_context_properties *properties, cl_uint count, const cl_device_id *devices, \
      void (CL_CALLBACK *notify)(const char *, const void *, size_t, void *), void *user, cl_int *error),              \
      (properties, count, devices, notify, user, error))                                                               \
    S(RetainContext, (cl_context context), (context))                                                                  \
    S(ReleaseContext, (cl_context context), (context))                                                                 \
    O(cl_command_queue, CreateCommandQueue, (cl_context context, cl_device_id device,                                  \
      cl_command_queue_properties properties, cl_int *error), (context, device, properties, error))                    \
    S(RetainCommandQueue, (cl_command_queue queue), (queue))                                                           \
    S(ReleaseCommandQueue, (cl_command_queue queue), (queue))                                                          \
    S(GetCommandQueueInfo, (cl_command_queue queue, cl_command_queue_info what, ENTRY_INFO),                           \
      (queue, what, bytes, value, bytes_ret))                                                                          \
    O(cl_program, CreateProgramWithSource, (cl_context context, cl_uint count, const char **texts,                     \
      const size_t *lengths, cl_int *error), (context, count, texts, lengths, error))                                  \
    O(cl_program, CreateProgramWithBinary, (cl_context context, cl_uint count, const cl_device_id *devices,            \
      const size_t *lengths, const unsigned char **binaries, cl_int *states, cl_int *error),                           \
      (context, count, devices, lengths, binaries, states, error))                                                     \
    S(BuildProgram, (cl_program program, cl_uint count, const cl_device_id *devices, const char *options,              \
      void (CL_CALLBACK *notify)(cl_program, void *), void *user), (program, count, devices, options, notify, user))   \
    S(GetProgramInfo, (cl_program program, cl_program_info what, ENTRY_INFO),                                          \
      (program, what, bytes, value, bytes_ret))                                                                        \
    S(GetProgramBuildInfo, (cl_program program, cl_device_id device, cl_program_build_info what, ENTRY_INFO),          \
      (program, device, what, bytes, value, bytes_ret))                                                                \
    S(ReleaseProgram, (cl_program program), (program))                                                                 \
    O(cl_kernel, CreateKernel, (cl_program program, const char *name, cl_int *error), (program, name, error))          \
    S(ReleaseKernel, (cl_kernel kernel), (kernel))                                                                     \
    S(GetKernelWorkGroupInfo, (cl_kernel kernel, cl_device_id device, cl_kernel_work_group_info what, ENTRY_INFO),     \
      (kernel, device, what, bytes, value, bytes_ret))                                                                 \
    S(SetKernelArg, (cl_kernel kernel, cl_uint index, size_t bytes, const void *value), (kernel, index, bytes, value)) \
    O(cl_mem, CreateBuffer, (cl_context context, cl_mem_flags flags, size_t bytes, void *host, cl_int *error),         \
      (context, flags, bytes, host, error))                                                                            \
    S(RetainMemObject, (cl_mem memory), (memory))                                                                      \
    S(GetMemObjectInfo, (cl_mem memory, cl_mem_info what, ENTRY_INFO), (memory, what, bytes, value, bytes_ret))        \
    S(ReleaseMemObject, (cl_mem memory), (memory))                                                                     \
    E(EnqueueReadBuffer, blocking, (cl_command_queue queue, cl_mem memory, cl_bool blocking, size_t offset,            \
      size_t bytes, void *to, ENTRY_WAITS), (queue, memory, blocking, offset, bytes, to, wait_count, waits, event))    \
    E(EnqueueWriteBuffer, blocking, (cl_command_queue queue, cl_mem memory, cl_bool blocking, size_t offset,           \
      size_t bytes, const void *from, ENTRY_WAITS),                                                                    \
      (queue, memory, blocking, offset, bytes, from, wait_count, waits, event))                                        \
    E(EnqueueFillBuffer, false, (cl_command_queue queue, cl_mem memory, const void *pattern, size_t pattern_bytes,     \
      size_t offset, size_t bytes, ENTRY_WAITS),                                                                       \
      (queue, memory, pattern, pattern_bytes, offset, bytes, wait_count, waits, event))                                \
    M(void *, EnqueueMapBuffer, (cl_command_queue queue, cl_mem memory, cl_bool blocking, cl_map_flags flags,          \
      size_t offset, size_t bytes, ENTRY_WAITS, cl_int *error),                                                        \
      (queue, memory, blocking, flags, offset, bytes, wait_count, waits, event, error))                                \
    E(EnqueueUnmapMemObject, false, (cl_command_queue queue, cl_mem memory, void *mapped, ENTRY_WAITS),                \
      (queue, memory, mapped, wait_count, waits, event))                                                               \
    E(EnqueueNDRangeKernel, false, (cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t *first, \
      const size_t *global, const size_t *local, ENTRY_WAITS),                                                         \
      (queue, kernel, dimensions, first, global, local, wait_count, waits, event))                                     \
    E(EnqueueMarkerWithWaitList, false, (cl_command_queue queue, ENTRY_WAITS), (queue, wait_count, waits, event))      \
    E(EnqueueBarrierWithWaitList, false, (cl_command_queue queue, ENTRY_WAITS), (queue, wait_count, waits, event))     \
    S(ReleaseEvent, (cl_event event), (event))                                                                         \
    S(Flush, (cl_command_queue queue), (queue))                                                                        \
    S(Finish, (cl_command_queue queue), (queue))
/* clang-format on */

#endif
