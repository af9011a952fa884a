/* RTAPI: what realtime components and HAL programs use of the system beneath HAL.

   Compile with -DRTAPI for a realtime component (loaded by `loadrt`), with -DULAPI for a program (started by `loadusr`, linked with
   -llinuxcnchal). halcompile does both. Calls give 0 or more, or a negative errno.

   "realtime" beside a call: a HAL function may call it. All the rest is for rtapi_app_main, rtapi_app_exit and programs. */
#ifndef RTAPI_H
#define RTAPI_H

#if !defined(RTAPI) && !defined(ULAPI)
#error "define RTAPI (realtime component) or ULAPI (program) before rtapi.h: halcompile does it"
#endif
#if defined(RTAPI) && defined(ULAPI)
#error "RTAPI and ULAPI exclude each other"
#endif

#include <stdarg.h>
#include <stddef.h>

#include <rtapi_bool.h>
#include <rtapi_errno.h>
#include <rtapi_stdint.h>

#define RTAPI_NAME_LEN 31

#ifdef __cplusplus
#define RTAPI_BEGIN_DECLS extern "C" {
#define RTAPI_END_DECLS }
#else
#define RTAPI_BEGIN_DECLS
#define RTAPI_END_DECLS
#endif

#define RTAPI_PRINTF_(fmt, first) __attribute__((format(printf, fmt, first)))

RTAPI_BEGIN_DECLS

/* ---- modules ---- */

/* A positive id for the calls below. Components need not call it: the id of hal_init() serves too. */
extern int rtapi_init(const char* modname);
extern int rtapi_exit(int module_id);

/* ---- text ---- */

/* As snprintf(3), with its conversions but %n and wide characters; `long double` is printed as double. Allocates nothing. The value is
   the length that the whole text would have. realtime */
extern int rtapi_snprintf(char* buffer, unsigned long size, const char* fmt, ...)
    RTAPI_PRINTF_(3, 4);
extern int rtapi_vsnprintf(char* buffer, unsigned long size, const char* fmt, va_list ap)
    RTAPI_PRINTF_(3, 0);

typedef enum {
  RTAPI_MSG_NONE = 0,
  RTAPI_MSG_ERR,
  RTAPI_MSG_WARN,
  RTAPI_MSG_INFO,
  RTAPI_MSG_DBG,
  RTAPI_MSG_ALL
} msg_level_t;

/* To stderr (rtapi_print: stdout), at most 1023 bytes. From a realtime function the text goes through a ring that the ordinary
   thread empties; when it is full the message is lost and counted. realtime */
extern void rtapi_print(const char* fmt, ...) RTAPI_PRINTF_(1, 2);
/* Printed when `level` is at most the level set (default RTAPI_MSG_ERR). realtime */
extern void rtapi_print_msg(msg_level_t level, const char* fmt, ...) RTAPI_PRINTF_(2, 3);
extern int rtapi_set_msg_level(int level);
extern int rtapi_get_msg_level(void);
typedef void (*rtapi_msg_handler_t)(msg_level_t level, const char* fmt, va_list ap);
/* Whoever prints from now on; null: the handler from the beginning. */
extern void rtapi_set_msg_handler(rtapi_msg_handler_t handler);
extern rtapi_msg_handler_t rtapi_get_msg_handler(void);

/* ---- time ---- */

/* Nanoseconds of the instance's clock (virtual time on a virtual clock). realtime */
extern long long rtapi_get_time(void);
/* Ticks of the processor's counter, nanoseconds where it has none. realtime */
extern long long rtapi_get_clocks(void);
/* Waits busily, at most rtapi_delay_max() ns. On the virtual clock it returns at once. realtime */
extern void rtapi_delay(long nsec);
extern long rtapi_delay_max(void);

/* ---- shared memory ---- */

/* Memory of at least `size` bytes that all who name the same `key` share, zero at first; in the instance's segment, so two
   instances do not meet. A handle, the same one for the same key. */
extern int rtapi_shmem_new(int key, int module_id, unsigned long size);
extern int rtapi_shmem_delete(int handle, int module_id);
extern int rtapi_shmem_getptr(int handle, void** ptr); /* realtime */

/* ---- the machine ---- */

typedef enum {
  REALTIME_TYPE_UNINITIALIZED = -1,
  REALTIME_TYPE_NONE = 0,
  REALTIME_TYPE_UNKNOWN,
  REALTIME_TYPE_PREEMPT_DYNAMIC,
  REALTIME_TYPE_PREEMPT_RT,
  REALTIME_TYPE_RTAI,
  REALTIME_TYPE_LXRT,
  REALTIME_TYPE_XENOMAI,
  REALTIME_TYPE_XENOMAI_EVL
} hal_realtime_type_t;
typedef hal_realtime_type_t rtapi_realtime_type_t;

extern int rtapi_is_kernelspace(void); /* always 0 */
/* 1 when the kernel is made for realtime (PREEMPT_RT). */
extern int rtapi_is_realtime(void);
extern rtapi_realtime_type_t rtapi_get_realtime_type(void);

extern long simple_strtol(const char* text, char** end, int base); /* realtime */

#ifdef RTAPI

/* ---- tasks: priorities; larger numbers are more urgent ---- */
extern int rtapi_prio_highest(void);
extern int rtapi_prio_lowest(void);
extern int rtapi_prio_next_higher(int prio);
extern int rtapi_prio_next_lower(int prio);

#define RTAPI_NO_FP 0
#define RTAPI_USES_FP 1

/* Tasks beside the threads of HAL, for rtapi_app_main() and rtapi_app_exit(). A task is made paused: rtapi_task_start() runs it each
   period, rtapi_task_resume() without pause. Its code loops and calls rtapi_wait(), where it also stands after rtapi_task_pause() (which
   may be called by anybody) and ends at rtapi_task_delete(); a module's tasks end after its rtapi_app_exit(). An id, or -EINVAL. */
extern int rtapi_task_new(void (*taskcode)(void*), void* arg, int prio, int owner,
                          unsigned long stacksize, int uses_fp);
extern int rtapi_task_delete(int task_id);
extern int rtapi_task_start(int task_id, unsigned long period_nsec);
extern int rtapi_task_resume(int task_id);
extern int rtapi_task_pause(int task_id);
/* In a task: until its next period. Within a HAL function there is nothing to wait for, the thread does it. 0. realtime */
extern int rtapi_wait(void);
/* Id of the task, or number of the HAL thread, that runs; otherwise -EINVAL. realtime */
extern int rtapi_task_self(void);
/* The task's periods count from now on. 0. realtime */
extern int rtapi_task_self_resync(void);
/* Start of the present cycle on the clock of rtapi_get_time(), 0 outside of one. realtime */
extern long long rtapi_task_pll_get_reference(void);
/* Moves the thread's next wake-up by `value` ns, a hundredth of its period at most. -EINVAL outside a cycle. realtime */
extern int rtapi_task_pll_set_correction(long value);
/* Period of the fastest thread; a period given is granted when no thread exists yet. */
extern long rtapi_clock_set_period(long nsec);

/* ---- I/O ports ---- see rtapi_io.h. realtime */
extern void rtapi_outb(unsigned char byte, unsigned int port);
extern unsigned char rtapi_inb(unsigned int port);

/* ---- programs and files with the rights of the realtime process; a descriptor or pid, or a negative errno ---- */
extern int rtapi_spawn_as_root(int* pid, const char* path, const void* file_actions,
                               const void* attributes, char* const argv[], char* const envp[]);
extern int rtapi_spawnp_as_root(int* pid, const char* file, const void* file_actions,
                                const void* attributes, char* const argv[], char* const envp[]);
extern int rtapi_open_as_root(const char* filename, int flags);

#endif /* RTAPI */

RTAPI_END_DECLS

/* ---- parameters of modules: see rtapi_app.h ---- */

#endif
