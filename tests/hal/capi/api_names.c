/* Every published name with its type and every constant with its value: this file compiles, or something is missing. Built once with
   RTAPI and once with ULAPI, in C and in C++. */
#include <hal.h>
#include <hal_parport.h>
#include <rtapi.h>
#include <rtapi_atomic.h>
#include <rtapi_bitops.h>
#include <rtapi_bool.h>
#include <rtapi_byteorder.h>
#include <rtapi_ctype.h>
#include <rtapi_device.h>
#include <rtapi_errno.h>
#include <rtapi_firmware.h>
#include <rtapi_gfp.h>
#include <rtapi_io.h>
#include <rtapi_limits.h>
#include <rtapi_list.h>
#include <rtapi_math.h>
#include <rtapi_math64.h>
#include <rtapi_math_i386.h>
#include <rtapi_mutex.h>
#include <rtapi_parport.h>
#include <rtapi_pci.h>
#include <rtapi_slab.h>
#include <rtapi_stdint.h>
#include <rtapi_string.h>
#include <rtapi_vsnprintf.h>
#include <emcmotcfg.h>
#include <emcpos.h>
#include <emcpose.h>
#include <kinematics.h>
#include <motion_types.h>
#include <homing.h>
#include <linuxcnc.h>
#include <posemath.h>
#include <posemath_types.h>
#include <switchkins.h>
#ifdef RTAPI
#include <rtapi_app.h>
#endif

#ifdef __cplusplus
#define SAME(a, b) static_assert((a) == (b), #a)
#else
#define SAME(a, b) _Static_assert((a) == (b), #a)
#endif
SAME(sizeof(PmLine), 192);
SAME(sizeof(PmCartLine), 88);
SAME(sizeof(PmCircle), 144);
SAME(sizeof(PmHomogeneous), 96);
SAME(sizeof(kparms), 48);
SAME(PM_DIV_ERR, -4);
SAME(sizeof(hal_bool), sizeof(hal_bit_t));
SAME(LINELEN, 255);
SAME(HAL_TYPE_UNSPECIFIED, -1);
SAME(HAL_TYPE_UNINITIALIZED, 0);
SAME(HAL_BIT, 1);
SAME(HAL_FLOAT, 2);
SAME(HAL_S32, 3);
SAME(HAL_U32, 4);
SAME(HAL_PORT, 5);
SAME(HAL_S64, 6);
SAME(HAL_U64, 7);
SAME(HAL_TYPE_MAX, 8);
SAME(HAL_BOOL, 1);
SAME(HAL_REAL, 2);
SAME(HAL_SINT, 6);
SAME(HAL_UINT, 7);
SAME(HAL_DIR_UNSPECIFIED, -1);
SAME(HAL_IN, 16);
SAME(HAL_OUT, 32);
SAME(HAL_IO, 48);
SAME(HAL_RO, 64);
SAME(HAL_WO, 128);
SAME(HAL_RW, 192);
SAME(HAL_NAME_LEN, 55);
SAME(RTAPI_NAME_LEN, 31);
SAME(HAL_STREAM_MAX_PINS, 21);
SAME(HAL_PORT_SIZE_MAX, 65536);
SAME(HAL_LOCK_NONE, 0);
SAME(HAL_LOCK_LOAD, 1);
SAME(HAL_LOCK_CONFIG, 2);
SAME(HAL_LOCK_PARAMS, 4);
SAME(HAL_LOCK_RUN, 8);
SAME(HAL_LOCK_TUNE, 3);
SAME(HAL_LOCK_ALL, 255);
SAME(HAL_COMP_TYPE_UNKNOWN, -1);
SAME(HAL_COMP_TYPE_USER, 0);
SAME(HAL_COMP_TYPE_REALTIME, 1);
SAME(HAL_COMP_TYPE_OTHER, 2);
SAME(COMPONENT_TYPE_USER, 0);
SAME(RTAPI_MSG_NONE, 0);
SAME(RTAPI_MSG_ERR, 1);
SAME(RTAPI_MSG_WARN, 2);
SAME(RTAPI_MSG_INFO, 3);
SAME(RTAPI_MSG_DBG, 4);
SAME(RTAPI_MSG_ALL, 5);
SAME(REALTIME_TYPE_UNINITIALIZED, -1);
SAME(REALTIME_TYPE_NONE, 0);
SAME(REALTIME_TYPE_UNKNOWN, 1);
SAME(REALTIME_TYPE_PREEMPT_DYNAMIC, 2);
SAME(REALTIME_TYPE_PREEMPT_RT, 3);
SAME(REALTIME_TYPE_RTAI, 4);
SAME(REALTIME_TYPE_LXRT, 5);
SAME(REALTIME_TYPE_XENOMAI, 6);
SAME(REALTIME_TYPE_XENOMAI_EVL, 7);
SAME(KINEMATICS_IDENTITY, 1);
SAME(KINEMATICS_FORWARD_ONLY, 2);
SAME(KINEMATICS_INVERSE_ONLY, 3);
SAME(KINEMATICS_BOTH, 4);
SAME(EMCMOT_MAX_JOINTS, 16);
SAME(EMCMOT_MAX_AXIS, 9);
SAME(EMCMOT_MAX_SPINDLES, 8);
SAME(EMCMOT_MAX_DIO, 64);
SAME(EMCMOT_MAX_AIO, 64);
SAME(EMC_MOTION_TYPE_TRAVERSE, 1);
SAME(EMC_MOTION_TYPE_INDEXROTARY, 6);
SAME(sizeof(hal_bit_t), 1);
SAME(sizeof(hal_s32_t), 4);
SAME(sizeof(hal_u32_t), 4);
SAME(sizeof(hal_s64_t), 8);
SAME(sizeof(hal_u64_t), 8);
SAME(sizeof(hal_float_t), 8);
SAME(sizeof(hal_port_t), 4);
SAME(sizeof(hal_data_u), 8);
SAME(sizeof(hal_stream_data_u), 8);
SAME(sizeof(real_t), 8);
SAME(sizeof(ireal_t), 8);
SAME(sizeof(EmcPose), 72);
SAME(sizeof(KINEMATICS_FORWARD_FLAGS), 8);

static int (*const check_hal_init)(const char*) __attribute__((unused)) = hal_init;
static int (*const check_hal_exit)(int) __attribute__((unused)) = hal_exit;
static int (*const check_hal_ready)(int) __attribute__((unused)) = hal_ready;
static void* (*const check_hal_malloc)(long) __attribute__((unused)) = hal_malloc;
static char* (*const check_hal_comp_name)(int) __attribute__((unused)) = hal_comp_name;
static int (*const check_hal_is_init)(void) __attribute__((unused)) = hal_is_init;
static const char* (*const check_hal_strerror)(int) __attribute__((unused)) = hal_strerror;
static hal_realtime_type_t (*const check_hal_get_realtime_type)(void) __attribute__((unused)) = hal_get_realtime_type;
static int (*const check_hal_pin_new)(const char*, hal_type_t, hal_pin_dir_t, void**, int) __attribute__((unused)) = hal_pin_new;
static int (*const check_hal_pin_alias)(const char*, const char*) __attribute__((unused)) = hal_pin_alias;
static int (*const check_hal_link)(const char*, const char*) __attribute__((unused)) = hal_link;
static int (*const check_hal_unlink)(const char*) __attribute__((unused)) = hal_unlink;
static int (*const check_hal_pin_new_port)(int, hal_pdir_t, hal_sint_t*, const char*, ...) __attribute__((unused)) = hal_pin_new_port;
static int (*const check_hal_param_new_fake)(int, hal_refs_u*) __attribute__((unused)) = hal_param_new_fake;
static rtapi_s32 (*const check_hal_get_si32_clamped)(const hal_sint_t) __attribute__((unused)) = hal_get_si32_clamped;
static rtapi_u32 (*const check_hal_get_ui32_clamped)(const hal_uint_t) __attribute__((unused)) = hal_get_ui32_clamped;
static int (*const check_hal_param_new)(const char*, hal_type_t, hal_param_dir_t, void*, int) __attribute__((unused)) = hal_param_new;
static int (*const check_hal_param_bit_set)(const char*, int) __attribute__((unused)) = hal_param_bit_set;
static int (*const check_hal_param_float_set)(const char*, double) __attribute__((unused)) = hal_param_float_set;
static int (*const check_hal_param_u32_set)(const char*, unsigned long) __attribute__((unused)) = hal_param_u32_set;
static int (*const check_hal_param_u64_set)(const char*, unsigned long) __attribute__((unused)) = hal_param_u64_set;
static int (*const check_hal_param_s32_set)(const char*, signed long) __attribute__((unused)) = hal_param_s32_set;
static int (*const check_hal_param_s64_set)(const char*, signed long) __attribute__((unused)) = hal_param_s64_set;
static int (*const check_hal_param_set)(const char*, hal_type_t, void*) __attribute__((unused)) = hal_param_set;
static int (*const check_hal_param_alias)(const char*, const char*) __attribute__((unused)) = hal_param_alias;
static int (*const check_hal_signal_new)(const char*, hal_type_t) __attribute__((unused)) = hal_signal_new;
static int (*const check_hal_signal_delete)(const char*) __attribute__((unused)) = hal_signal_delete;
static int (*const check_hal_thread_delete)(const char*) __attribute__((unused)) = hal_thread_delete;
static int (*const check_hal_add_funct_to_thread)(const char*, const char*, int) __attribute__((unused)) = hal_add_funct_to_thread;
static int (*const check_hal_init_funct_to_thread)(const char*, const char*, int) __attribute__((unused)) = hal_init_funct_to_thread;
static int (*const check_hal_del_funct_from_thread)(const char*, const char*) __attribute__((unused)) = hal_del_funct_from_thread;
static int (*const check_hal_start_threads)(void) __attribute__((unused)) = hal_start_threads;
static int (*const check_hal_stop_threads)(void) __attribute__((unused)) = hal_stop_threads;
static bool (*const check_hal_port_read)(const hal_port_t*, char*, unsigned) __attribute__((unused)) = hal_port_read;
static bool (*const check_hal_port_peek)(const hal_port_t*, char*, unsigned) __attribute__((unused)) = hal_port_peek;
static bool (*const check_hal_port_peek_commit)(const hal_port_t*, unsigned) __attribute__((unused)) = hal_port_peek_commit;
static bool (*const check_hal_port_write)(const hal_port_t*, const char*, unsigned) __attribute__((unused)) = hal_port_write;
static unsigned (*const check_hal_port_readable)(const hal_port_t*) __attribute__((unused)) = hal_port_readable;
static unsigned (*const check_hal_port_writable)(const hal_port_t*) __attribute__((unused)) = hal_port_writable;
static unsigned (*const check_hal_port_buffer_size)(const hal_port_t*) __attribute__((unused)) = hal_port_buffer_size;
static void (*const check_hal_port_clear)(const hal_port_t*) __attribute__((unused)) = hal_port_clear;
static int (*const check_hal_stream_create)(hal_stream_t*, int, int, unsigned, const char*) __attribute__((unused)) = hal_stream_create;
static int (*const check_hal_stream_attach)(hal_stream_t*, int, int, const char*) __attribute__((unused)) = hal_stream_attach;
static void (*const check_hal_stream_destroy)(hal_stream_t*) __attribute__((unused)) = hal_stream_destroy;
static void (*const check_hal_stream_detach)(hal_stream_t*) __attribute__((unused)) = hal_stream_detach;
static int (*const check_hal_stream_element_count)(hal_stream_t*) __attribute__((unused)) = hal_stream_element_count;
static hal_type_t (*const check_hal_stream_element_type)(hal_stream_t*, int) __attribute__((unused)) = hal_stream_element_type;
static int (*const check_hal_stream_read)(hal_stream_t*, hal_stream_data_u*, unsigned*) __attribute__((unused)) = hal_stream_read;
static int (*const check_hal_stream_write)(hal_stream_t*, hal_stream_data_u*) __attribute__((unused)) = hal_stream_write;
static bool (*const check_hal_stream_readable)(hal_stream_t*) __attribute__((unused)) = hal_stream_readable;
static bool (*const check_hal_stream_writable)(hal_stream_t*) __attribute__((unused)) = hal_stream_writable;
static int (*const check_hal_stream_depth)(hal_stream_t*) __attribute__((unused)) = hal_stream_depth;
static unsigned (*const check_hal_stream_maxdepth)(hal_stream_t*) __attribute__((unused)) = hal_stream_maxdepth;
static int (*const check_hal_stream_num_underruns)(hal_stream_t*) __attribute__((unused)) = hal_stream_num_underruns;
static int (*const check_hal_stream_num_overruns)(hal_stream_t*) __attribute__((unused)) = hal_stream_num_overruns;
static rtapi_s64 (*const check_hal_extend_counter)(rtapi_s64, rtapi_s64, int) __attribute__((unused)) = hal_extend_counter;
static int (*const check_rtapi_init)(const char*) __attribute__((unused)) = rtapi_init;
static int (*const check_rtapi_exit)(int) __attribute__((unused)) = rtapi_exit;
static int (*const check_rtapi_snprintf)(char*, unsigned long, const char*, ...) __attribute__((unused)) = rtapi_snprintf;
static int (*const check_rtapi_vsnprintf)(char*, unsigned long, const char*, va_list) __attribute__((unused)) = rtapi_vsnprintf;
static void (*const check_rtapi_print)(const char*, ...) __attribute__((unused)) = rtapi_print;
static void (*const check_rtapi_print_msg)(msg_level_t, const char*, ...) __attribute__((unused)) = rtapi_print_msg;
static int (*const check_rtapi_set_msg_level)(int) __attribute__((unused)) = rtapi_set_msg_level;
static int (*const check_rtapi_get_msg_level)(void) __attribute__((unused)) = rtapi_get_msg_level;
static void (*const check_rtapi_set_msg_handler)(rtapi_msg_handler_t) __attribute__((unused)) = rtapi_set_msg_handler;
static rtapi_msg_handler_t (*const check_rtapi_get_msg_handler)(void) __attribute__((unused)) = rtapi_get_msg_handler;
static void (*const check_rtapi_delay)(long) __attribute__((unused)) = rtapi_delay;
static long (*const check_rtapi_delay_max)(void) __attribute__((unused)) = rtapi_delay_max;
static long long (*const check_rtapi_get_time)(void) __attribute__((unused)) = rtapi_get_time;
static int (*const check_rtapi_shmem_new)(int, int, unsigned long) __attribute__((unused)) = rtapi_shmem_new;
static int (*const check_rtapi_shmem_delete)(int, int) __attribute__((unused)) = rtapi_shmem_delete;
static int (*const check_rtapi_shmem_getptr)(int, void**) __attribute__((unused)) = rtapi_shmem_getptr;
static long (*const check_simple_strtol)(const char*, char**, int) __attribute__((unused)) = simple_strtol;
static int (*const check_rtapi_is_kernelspace)(void) __attribute__((unused)) = rtapi_is_kernelspace;
static int (*const check_rtapi_is_realtime)(void) __attribute__((unused)) = rtapi_is_realtime;
static int (*const check_hal_pin_bit_new)(const char*, hal_pin_dir_t, hal_bit_t**, int) __attribute__((unused)) = hal_pin_bit_new;
static int (*const check_hal_pin_bit_newf)(hal_pin_dir_t, hal_bit_t**, int, const char*, ...) __attribute__((unused)) = hal_pin_bit_newf;
static int (*const check_hal_param_bit_new)(const char*, hal_param_dir_t, hal_bit_t*, int) __attribute__((unused)) = hal_param_bit_new;
static int (*const check_hal_param_bit_newf)(hal_param_dir_t, hal_bit_t*, int, const char*, ...) __attribute__((unused)) = hal_param_bit_newf;
static int (*const check_hal_pin_float_new)(const char*, hal_pin_dir_t, hal_float_t**, int) __attribute__((unused)) = hal_pin_float_new;
static int (*const check_hal_pin_float_newf)(hal_pin_dir_t, hal_float_t**, int, const char*, ...) __attribute__((unused)) = hal_pin_float_newf;
static int (*const check_hal_param_float_new)(const char*, hal_param_dir_t, hal_float_t*, int) __attribute__((unused)) = hal_param_float_new;
static int (*const check_hal_param_float_newf)(hal_param_dir_t, hal_float_t*, int, const char*, ...) __attribute__((unused)) = hal_param_float_newf;
static int (*const check_hal_pin_u32_new)(const char*, hal_pin_dir_t, hal_u32_t**, int) __attribute__((unused)) = hal_pin_u32_new;
static int (*const check_hal_pin_u32_newf)(hal_pin_dir_t, hal_u32_t**, int, const char*, ...) __attribute__((unused)) = hal_pin_u32_newf;
static int (*const check_hal_param_u32_new)(const char*, hal_param_dir_t, hal_u32_t*, int) __attribute__((unused)) = hal_param_u32_new;
static int (*const check_hal_param_u32_newf)(hal_param_dir_t, hal_u32_t*, int, const char*, ...) __attribute__((unused)) = hal_param_u32_newf;
static int (*const check_hal_pin_s32_new)(const char*, hal_pin_dir_t, hal_s32_t**, int) __attribute__((unused)) = hal_pin_s32_new;
static int (*const check_hal_pin_s32_newf)(hal_pin_dir_t, hal_s32_t**, int, const char*, ...) __attribute__((unused)) = hal_pin_s32_newf;
static int (*const check_hal_param_s32_new)(const char*, hal_param_dir_t, hal_s32_t*, int) __attribute__((unused)) = hal_param_s32_new;
static int (*const check_hal_param_s32_newf)(hal_param_dir_t, hal_s32_t*, int, const char*, ...) __attribute__((unused)) = hal_param_s32_newf;
static int (*const check_hal_pin_u64_new)(const char*, hal_pin_dir_t, hal_u64_t**, int) __attribute__((unused)) = hal_pin_u64_new;
static int (*const check_hal_pin_u64_newf)(hal_pin_dir_t, hal_u64_t**, int, const char*, ...) __attribute__((unused)) = hal_pin_u64_newf;
static int (*const check_hal_param_u64_new)(const char*, hal_param_dir_t, hal_u64_t*, int) __attribute__((unused)) = hal_param_u64_new;
static int (*const check_hal_param_u64_newf)(hal_param_dir_t, hal_u64_t*, int, const char*, ...) __attribute__((unused)) = hal_param_u64_newf;
static int (*const check_hal_pin_s64_new)(const char*, hal_pin_dir_t, hal_s64_t**, int) __attribute__((unused)) = hal_pin_s64_new;
static int (*const check_hal_pin_s64_newf)(hal_pin_dir_t, hal_s64_t**, int, const char*, ...) __attribute__((unused)) = hal_pin_s64_newf;
static int (*const check_hal_param_s64_new)(const char*, hal_param_dir_t, hal_s64_t*, int) __attribute__((unused)) = hal_param_s64_new;
static int (*const check_hal_param_s64_newf)(hal_param_dir_t, hal_s64_t*, int, const char*, ...) __attribute__((unused)) = hal_param_s64_newf;
static int (*const check_hal_pin_port_new)(const char*, hal_pin_dir_t, hal_port_t**, int) __attribute__((unused)) = hal_pin_port_new;
static int (*const check_hal_pin_port_newf)(hal_pin_dir_t, hal_port_t**, int, const char*, ...) __attribute__((unused)) = hal_pin_port_newf;
static int (*const check_hal_pin_new_bool)(int, hal_pdir_t, hal_bool_t*, rtapi_bool, const char*, ...) __attribute__((unused)) = hal_pin_new_bool;
static int (*const check_hal_param_new_bool)(int, hal_pdir_t, hal_bool_t*, rtapi_bool, const char*, ...) __attribute__((unused)) = hal_param_new_bool;
static rtapi_bool (*const check_hal_get_bool)(const hal_bool_t) __attribute__((unused)) = hal_get_bool;
static rtapi_bool (*const check_hal_set_bool)(hal_bool_t, rtapi_bool) __attribute__((unused)) = hal_set_bool;
static int (*const check_hal_pin_new_si32)(int, hal_pdir_t, hal_sint_t*, rtapi_s32, const char*, ...) __attribute__((unused)) = hal_pin_new_si32;
static int (*const check_hal_param_new_si32)(int, hal_pdir_t, hal_sint_t*, rtapi_s32, const char*, ...) __attribute__((unused)) = hal_param_new_si32;
static rtapi_s32 (*const check_hal_get_si32)(const hal_sint_t) __attribute__((unused)) = hal_get_si32;
static rtapi_s32 (*const check_hal_set_si32)(hal_sint_t, rtapi_s32) __attribute__((unused)) = hal_set_si32;
static int (*const check_hal_pin_new_ui32)(int, hal_pdir_t, hal_uint_t*, rtapi_u32, const char*, ...) __attribute__((unused)) = hal_pin_new_ui32;
static int (*const check_hal_param_new_ui32)(int, hal_pdir_t, hal_uint_t*, rtapi_u32, const char*, ...) __attribute__((unused)) = hal_param_new_ui32;
static rtapi_u32 (*const check_hal_get_ui32)(const hal_uint_t) __attribute__((unused)) = hal_get_ui32;
static rtapi_u32 (*const check_hal_set_ui32)(hal_uint_t, rtapi_u32) __attribute__((unused)) = hal_set_ui32;
static int (*const check_hal_pin_new_sint)(int, hal_pdir_t, hal_sint_t*, rtapi_sint, const char*, ...) __attribute__((unused)) = hal_pin_new_sint;
static int (*const check_hal_param_new_sint)(int, hal_pdir_t, hal_sint_t*, rtapi_sint, const char*, ...) __attribute__((unused)) = hal_param_new_sint;
static rtapi_sint (*const check_hal_get_sint)(const hal_sint_t) __attribute__((unused)) = hal_get_sint;
static rtapi_sint (*const check_hal_set_sint)(hal_sint_t, rtapi_sint) __attribute__((unused)) = hal_set_sint;
static int (*const check_hal_pin_new_uint)(int, hal_pdir_t, hal_uint_t*, rtapi_uint, const char*, ...) __attribute__((unused)) = hal_pin_new_uint;
static int (*const check_hal_param_new_uint)(int, hal_pdir_t, hal_uint_t*, rtapi_uint, const char*, ...) __attribute__((unused)) = hal_param_new_uint;
static rtapi_uint (*const check_hal_get_uint)(const hal_uint_t) __attribute__((unused)) = hal_get_uint;
static rtapi_uint (*const check_hal_set_uint)(hal_uint_t, rtapi_uint) __attribute__((unused)) = hal_set_uint;
static int (*const check_hal_pin_new_real)(int, hal_pdir_t, hal_real_t*, rtapi_real, const char*, ...) __attribute__((unused)) = hal_pin_new_real;
static int (*const check_hal_param_new_real)(int, hal_pdir_t, hal_real_t*, rtapi_real, const char*, ...) __attribute__((unused)) = hal_param_new_real;
static rtapi_real (*const check_hal_get_real)(const hal_real_t) __attribute__((unused)) = hal_get_real;
static rtapi_real (*const check_hal_set_real)(hal_real_t, rtapi_real) __attribute__((unused)) = hal_set_real;

#ifdef RTAPI
static int (*const check_hal_export_funct)(const char*, void (*)(void*, long), void*, int, int, int) __attribute__((unused)) = hal_export_funct;
static int (*const check_hal_export_functf)(void (*)(void*, long), void*, int, int, int, const char*, ...) __attribute__((unused)) = hal_export_functf;
static int (*const check_hal_create_thread)(const char*, unsigned long, int) __attribute__((unused)) = hal_create_thread;
static int (*const check_hal_set_constructor)(int, int (*)(const char*, const char*)) __attribute__((unused)) = hal_set_constructor;
static int (*const check_rtapi_app_main)(void) __attribute__((unused)) = rtapi_app_main;
static void (*const check_rtapi_app_exit)(void) __attribute__((unused)) = rtapi_app_exit;
static long (*const check_rtapi_clock_set_period)(long) __attribute__((unused)) = rtapi_clock_set_period;
static int (*const check_rtapi_prio_highest)(void) __attribute__((unused)) = rtapi_prio_highest;
static int (*const check_rtapi_prio_lowest)(void) __attribute__((unused)) = rtapi_prio_lowest;
static int (*const check_rtapi_prio_next_higher)(int) __attribute__((unused)) = rtapi_prio_next_higher;
static int (*const check_rtapi_prio_next_lower)(int) __attribute__((unused)) = rtapi_prio_next_lower;
static int (*const check_rtapi_task_new)(void (*)(void*), void*, int, int, unsigned long, int) __attribute__((unused)) = rtapi_task_new;
static int (*const check_rtapi_task_delete)(int) __attribute__((unused)) = rtapi_task_delete;
static int (*const check_rtapi_task_start)(int, unsigned long) __attribute__((unused)) = rtapi_task_start;
static int (*const check_rtapi_task_resume)(int) __attribute__((unused)) = rtapi_task_resume;
static int (*const check_rtapi_task_pause)(int) __attribute__((unused)) = rtapi_task_pause;
static int (*const check_rtapi_wait)(void) __attribute__((unused)) = rtapi_wait;
static int (*const check_rtapi_task_self)(void) __attribute__((unused)) = rtapi_task_self;
static int (*const check_rtapi_task_self_resync)(void) __attribute__((unused)) = rtapi_task_self_resync;
static long long (*const check_rtapi_task_pll_get_reference)(void) __attribute__((unused)) = rtapi_task_pll_get_reference;
static int (*const check_rtapi_task_pll_set_correction)(long) __attribute__((unused)) = rtapi_task_pll_set_correction;
static void (*const check_rtapi_outb)(unsigned char, unsigned) __attribute__((unused)) = rtapi_outb;
static unsigned char (*const check_rtapi_inb)(unsigned) __attribute__((unused)) = rtapi_inb;
static int (*const check_rtapi_open_as_root)(const char*, int) __attribute__((unused)) = rtapi_open_as_root;
#endif

#ifdef ULAPI
static int (*const check_hal_unready)(int) __attribute__((unused)) = hal_unready;
static int (*const check_hal_set_unready)(int) __attribute__((unused)) = hal_set_unready;
static int (*const check_hal_lib_init)(void) __attribute__((unused)) = hal_lib_init;
static void (*const check_hal_lib_exit)(void) __attribute__((unused)) = hal_lib_exit;
static int (*const check_hal_set_lock)(unsigned char) __attribute__((unused)) = hal_set_lock;
static unsigned char (*const check_hal_get_lock)(void) __attribute__((unused)) = hal_get_lock;
static int (*const check_hal_get_pin_value_by_name)(const char*, hal_type_t*, hal_data_u**, bool*) __attribute__((unused)) = hal_get_pin_value_by_name;
static int (*const check_hal_get_signal_value_by_name)(const char*, hal_type_t*, hal_data_u**, bool*) __attribute__((unused)) = hal_get_signal_value_by_name;
static int (*const check_hal_get_param_value_by_name)(const char*, hal_type_t*, hal_data_u**) __attribute__((unused)) = hal_get_param_value_by_name;
static void (*const check_hal_port_wait_readable)(hal_port_t**, unsigned, sig_atomic_t*) __attribute__((unused)) = hal_port_wait_readable;
static void (*const check_hal_port_wait_writable)(hal_port_t**, unsigned, sig_atomic_t*) __attribute__((unused)) = hal_port_wait_writable;
static void (*const check_hal_stream_wait_readable)(hal_stream_t*, sig_atomic_t*) __attribute__((unused)) = hal_stream_wait_readable;
static void (*const check_hal_stream_wait_writable)(hal_stream_t*, sig_atomic_t*) __attribute__((unused)) = hal_stream_wait_writable;
static int (*const check_hal_getref_p)(hal_query_t*) __attribute__((unused)) = hal_getref_p;
static int (*const check_hal_getref_s)(hal_query_t*) __attribute__((unused)) = hal_getref_s;
static int (*const check_hal_comp_by_name)(const char*, hal_query_t*) __attribute__((unused)) = hal_comp_by_name;
static int (*const check_hal_comp_by_id)(int, hal_query_t*) __attribute__((unused)) = hal_comp_by_id;
static int (*const check_hal_statistics)(hal_statistics_t*) __attribute__((unused)) = hal_statistics;
static int (*const check_hal_mutex_force_release)(void) __attribute__((unused)) = hal_mutex_force_release;
static int (*const check_hal_enforce_exact_base_period)(void) __attribute__((unused)) = hal_enforce_exact_base_period;
static int (*const check_hal_get_p)(hal_query_t*, hal_query_cb, void*) __attribute__((unused)) = hal_get_p;
static int (*const check_hal_set_p)(hal_query_t*, hal_query_cb, void*) __attribute__((unused)) = hal_set_p;
static int (*const check_hal_get_s)(hal_query_t*, hal_query_cb, void*) __attribute__((unused)) = hal_get_s;
static int (*const check_hal_set_s)(hal_query_t*, hal_query_cb, void*) __attribute__((unused)) = hal_set_s;
static int (*const check_hal_list_p)(hal_query_t*, hal_query_cb, void*) __attribute__((unused)) = hal_list_p;
static int (*const check_hal_list_p_s)(hal_query_t*, hal_query_cb, void*) __attribute__((unused)) = hal_list_p_s;
static int (*const check_hal_list_s)(hal_query_t*, hal_query_cb, void*) __attribute__((unused)) = hal_list_s;
static int (*const check_hal_list_comp)(hal_query_t*, hal_query_cb, void*) __attribute__((unused)) = hal_list_comp;
static int (*const check_hal_list_funct)(hal_query_t*, hal_query_cb, void*) __attribute__((unused)) = hal_list_funct;
static int (*const check_hal_list_thread)(hal_query_t*, hal_query_cb, void*) __attribute__((unused)) = hal_list_thread;
#endif
