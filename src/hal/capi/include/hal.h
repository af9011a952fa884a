/* HAL: components, pins, parameters, signals, functions and threads, for components written in C.

   A component calls hal_init(), makes its pins and parameters, calls hal_ready(), and in the end hal_exit(). What a pin's pointer
   cell points to changes when the pin is linked: read `*cell` anew each time. Cells and parameters must stand in memory from
   hal_malloc(). Calls give 0 or more, or a negative errno after a line on stderr that says why.

   A component that ends in any way, also by a crash, is taken out of HAL with all that it made. */
#ifndef HAL_H
#define HAL_H

#include <rtapi.h>
#ifdef ULAPI
#include <signal.h>
#endif

RTAPI_BEGIN_DECLS

#define HAL_NAME_LEN 55
#define HAL_STREAM_MAX_PINS (21)
#define HAL_PORT_SIZE_MAX 65536
#define HAL_PSEUDO_COMP_PREFIX "__"

#define HAL_LOCK_NONE 0
#define HAL_LOCK_LOAD 1
#define HAL_LOCK_CONFIG 2
#define HAL_LOCK_PARAMS 4
#define HAL_LOCK_RUN 8
#define HAL_LOCK_TUNE (HAL_LOCK_LOAD | HAL_LOCK_CONFIG)
#define HAL_LOCK_ALL 255

/* ---- types ---- */

typedef enum {
  HAL_TYPE_UNSPECIFIED = -1,
  HAL_TYPE_UNINITIALIZED = 0,
  HAL_BIT = 1,
  HAL_FLOAT = 2,
  HAL_S32 = 3,
  HAL_U32 = 4,
  HAL_PORT = 5,
  HAL_S64 = 6,
  HAL_U64 = 7,
  HAL_TYPE_MAX = 8,
  HAL_BOOL = HAL_BIT,
  HAL_REAL = HAL_FLOAT,
  HAL_SINT = HAL_S64,
  HAL_UINT = HAL_U64
} hal_type_t;

typedef enum {
  HAL_DIR_UNSPECIFIED = -1,
  HAL_IN = 16,
  HAL_OUT = 32,
  HAL_IO = HAL_IN | HAL_OUT,
  HAL_RO = 64,
  HAL_WO = 128,
  HAL_RW = HAL_RO | HAL_WO
} hal_pdir_t;
typedef hal_pdir_t hal_pin_dir_t;
typedef hal_pdir_t hal_param_dir_t;
static inline bool hal_pdir_is_pin(hal_pdir_t dir) {
  return dir == HAL_IN || dir == HAL_OUT || dir == HAL_IO;
}
static inline bool hal_pdir_is_param(hal_pdir_t dir) { return dir == HAL_RO || dir == HAL_RW; }
static inline bool hal_pdir_is_neither(hal_pdir_t dir) {
  return !hal_pdir_is_pin(dir) && !hal_pdir_is_param(dir);
}

typedef enum {
  HAL_COMP_TYPE_UNKNOWN = -1,
  HAL_COMP_TYPE_USER = 0,
  HAL_COMP_TYPE_REALTIME = 1,
  HAL_COMP_TYPE_OTHER = 2,
  COMPONENT_TYPE_UNKNOWN = HAL_COMP_TYPE_UNKNOWN,
  COMPONENT_TYPE_USER = HAL_COMP_TYPE_USER,
  COMPONENT_TYPE_REALTIME = HAL_COMP_TYPE_REALTIME,
  COMPONENT_TYPE_OTHER = HAL_COMP_TYPE_OTHER
} hal_comp_type_t;
typedef hal_comp_type_t component_type_t;

/* Values as others may change them at any moment. */
typedef bool hal_bool;
typedef volatile bool hal_bit_t;
typedef volatile rtapi_s32 hal_s32_t;
typedef volatile rtapi_u32 hal_u32_t;
typedef volatile rtapi_s64 hal_s64_t;
typedef volatile rtapi_u64 hal_u64_t;
typedef volatile double hal_float_t __attribute__((aligned(8)));
typedef volatile int hal_port_t; /* a handle: 0 while no buffer is there */
/* For calculating with them. */
typedef rtapi_real real_t __attribute__((aligned(8)));
typedef rtapi_u64 ireal_t __attribute__((aligned(8)));

typedef union {
  hal_bit_t b;
  hal_s32_t s;
  hal_u32_t u;
  hal_float_t f;
  hal_port_t p;
  hal_s64_t ls;
  hal_u64_t lu;
} hal_data_u;

/* References to pins and parameters of the newest kind; hal_get_*() and hal_set_*() go through them. They may stand anywhere. */
typedef struct hal_bool_item_* hal_bool_t;
typedef struct hal_sint_item_* hal_sint_t;
typedef struct hal_uint_item_* hal_uint_t;
typedef struct hal_real_item_* hal_real_t;
typedef union {
  hal_bool_t b;
  hal_sint_t s;
  hal_uint_t u;
  hal_real_t r;
} hal_refs_u;

/* ---- components ---- */

/* A positive id, or a negative errno; -EEXIST when the name is taken. */
extern int hal_init(const char* name);
extern int hal_exit(int comp_id);
/* No more pins after this; scripts that wait for the component go on. */
extern int hal_ready(int comp_id);
/* Zero-filled, aligned for every type; given back when whoever asked for it ends. Null after an error. */
extern void* hal_malloc(long size);
extern char* hal_comp_name(int comp_id);
/* 1 when this process has a HAL. */
extern int hal_is_init(void);
/* Text for a negative errno of these calls. */
extern const char* hal_strerror(int error);
extern hal_realtime_type_t hal_get_realtime_type(void);
/* For more pins after hal_ready (kinematics that make them when motion asks for their type); then hal_ready again. */
extern int hal_set_unready(int comp_id);
#ifdef ULAPI
extern int hal_unready(int comp_id);
extern int hal_lib_init(void);
extern void hal_lib_exit(void);
#endif
#ifdef RTAPI
typedef int (*constructor)(const char* prefix, const char* arg);
typedef constructor hal_constructor_t;
/* What hal_comp_invoke_make() calls. */
extern int hal_set_constructor(int comp_id, constructor make);
extern int hal_comp_invoke_make(const char* comp, const char* newname, const char* arg);
#endif

/* ---- pins with pointer cells ---- */

#define HAL_PIN_NEW_DECLARE_(T)                                                               \
  extern int hal_pin_##T##_new(const char* name, hal_pdir_t dir, hal_##T##_t** data_ptr_addr, \
                               int comp_id);                                                  \
  extern int hal_pin_##T##_newf(hal_pdir_t dir, hal_##T##_t** data_ptr_addr, int comp_id,     \
                                const char* fmt, ...) RTAPI_PRINTF_(4, 5);
HAL_PIN_NEW_DECLARE_(bit)
HAL_PIN_NEW_DECLARE_(float)
HAL_PIN_NEW_DECLARE_(u32)
HAL_PIN_NEW_DECLARE_(s32)
HAL_PIN_NEW_DECLARE_(u64)
HAL_PIN_NEW_DECLARE_(s64)
HAL_PIN_NEW_DECLARE_(port)
#undef HAL_PIN_NEW_DECLARE_
extern int hal_pin_new(const char* name, hal_type_t type, hal_pdir_t dir, void** data_ptr_addr,
                       int comp_id);
/* A second name; null takes it away. */
extern int hal_pin_alias(const char* pin_name, const char* alias);

/* ---- parameters ---- */

#define HAL_PARAM_NEW_DECLARE_(T)                                                          \
  extern int hal_param_##T##_new(const char* name, hal_pdir_t dir, hal_##T##_t* data_addr, \
                                 int comp_id);                                             \
  extern int hal_param_##T##_newf(hal_pdir_t dir, hal_##T##_t* data_addr, int comp_id,     \
                                  const char* fmt, ...) RTAPI_PRINTF_(4, 5);
HAL_PARAM_NEW_DECLARE_(bit)
HAL_PARAM_NEW_DECLARE_(float)
HAL_PARAM_NEW_DECLARE_(u32)
HAL_PARAM_NEW_DECLARE_(s32)
HAL_PARAM_NEW_DECLARE_(u64)
HAL_PARAM_NEW_DECLARE_(s64)
#undef HAL_PARAM_NEW_DECLARE_
extern int hal_param_new(const char* name, hal_type_t type, hal_pdir_t dir, void* data_addr,
                         int comp_id);
extern int hal_param_bit_set(const char* name, int value);
extern int hal_param_float_set(const char* name, double value);
extern int hal_param_u32_set(const char* name, unsigned long value);
extern int hal_param_s32_set(const char* name, signed long value);
extern int hal_param_u64_set(const char* name, unsigned long value);
extern int hal_param_s64_set(const char* name, signed long value);
extern int hal_param_set(const char* name, hal_type_t type, void* value_addr);
extern int hal_param_alias(const char* param_name, const char* alias);

/* ---- pins and parameters of the newest kind ---- */

#define HAL_ITEM_NEW_DECLARE_(N, R, V)                                               \
  extern int hal_pin_new_##N(int comp_id, hal_pdir_t dir, hal_##R##_t* ref, V def,   \
                             const char* fmt, ...) RTAPI_PRINTF_(5, 6);              \
  extern int hal_param_new_##N(int comp_id, hal_pdir_t dir, hal_##R##_t* ref, V def, \
                               const char* fmt, ...) RTAPI_PRINTF_(5, 6);            \
  extern V hal_get_##N(const hal_##R##_t ref);    /* realtime */                     \
  extern V hal_set_##N(hal_##R##_t ref, V value); /* gives the value; realtime */
HAL_ITEM_NEW_DECLARE_(bool, bool, rtapi_bool)
HAL_ITEM_NEW_DECLARE_(si32, sint, rtapi_s32)
HAL_ITEM_NEW_DECLARE_(ui32, uint, rtapi_u32)
HAL_ITEM_NEW_DECLARE_(sint, sint, rtapi_sint)
HAL_ITEM_NEW_DECLARE_(uint, uint, rtapi_uint)
HAL_ITEM_NEW_DECLARE_(real, real, rtapi_real)
#undef HAL_ITEM_NEW_DECLARE_
/* The value of a 64-bit item, held within 32 bits. realtime */
extern rtapi_s32 hal_get_si32_clamped(const hal_sint_t ref);
extern rtapi_u32 hal_get_ui32_clamped(const hal_uint_t ref);
extern int hal_pin_new_port(int comp_id, hal_pdir_t dir, hal_sint_t* ref, const char* fmt, ...)
    RTAPI_PRINTF_(4, 5);
/* A reference to a value that no name leads to, for code that wants one. */
extern int hal_param_new_fake(int comp_id, hal_refs_u* ref);

/* ---- signals ---- */

extern int hal_signal_new(const char* name, hal_type_t type);
extern int hal_signal_delete(const char* name);
extern int hal_link(const char* pin_name, const char* sig_name);
extern int hal_unlink(const char* pin_name);

/* ---- functions and threads ---- */

typedef void (*hal_funct_t)(void* arg, long period);
#ifdef RTAPI
extern int hal_export_funct(const char* name, void (*funct)(void*, long), void* arg, int uses_fp,
                            int reentrant, int comp_id);
extern int hal_export_functf(void (*funct)(void*, long), void* arg, int uses_fp, int reentrant,
                             int comp_id, const char* fmt, ...) RTAPI_PRINTF_(6, 7);
/* The fastest first. A positive id, or a negative errno. */
extern int hal_create_thread(const char* name, unsigned long period_nsec, int uses_fp);
#endif
extern int hal_thread_delete(const char* name);
/* `position` 1 is the first, -1 the last. */
extern int hal_add_funct_to_thread(const char* funct_name, const char* thread_name, int position);
/* The same for a function that runs once, in the thread's next cycle. */
extern int hal_init_funct_to_thread(const char* funct_name, const char* thread_name, int position);
extern int hal_del_funct_from_thread(const char* funct_name, const char* thread_name);
extern int hal_start_threads(void);
extern int hal_stop_threads(void);

/* ---- locks and values by name ---- */

#ifdef ULAPI
extern int hal_set_lock(unsigned char lock_type);
extern unsigned char hal_get_lock(void);
/* Where the value stands: good until the pin is linked anew or deleted. -1: no such name. */
extern int hal_get_pin_value_by_name(const char* name, hal_type_t* type, hal_data_u** data,
                                     bool* connected);
extern int hal_get_signal_value_by_name(const char* name, hal_type_t* type, hal_data_u** data,
                                        bool* has_writers);
extern int hal_get_param_value_by_name(const char* name, hal_type_t* type, hal_data_u** data);
#endif

/* ---- ports: streams of bytes from one writer to one reader; `sets SIGNAL BYTES` makes the buffer. realtime ---- */

/* All `count` bytes or none. */
extern bool hal_port_read(const hal_port_t* port, char* dest, unsigned count);
extern bool hal_port_peek(const hal_port_t* port, char* dest, unsigned count);
extern bool hal_port_peek_commit(const hal_port_t* port, unsigned count);
extern bool hal_port_write(const hal_port_t* port, const char* src, unsigned count);
extern unsigned hal_port_readable(const hal_port_t* port);
extern unsigned hal_port_writable(const hal_port_t* port);
extern unsigned hal_port_buffer_size(const hal_port_t* port);
/* The reader's business. */
extern void hal_port_clear(const hal_port_t* port);
#ifdef ULAPI
extern void hal_port_wait_readable(hal_port_t** port, unsigned count, sig_atomic_t* stop);
extern void hal_port_wait_writable(hal_port_t** port, unsigned count, sig_atomic_t* stop);
#endif

/* ---- streams: rows of values between a realtime component and a program ---- */

union hal_stream_data {
  rtapi_real f;
  bool b;
  rtapi_s32 s;
  rtapi_u32 u;
  rtapi_s64 l;
  rtapi_u64 k;
};
typedef union hal_stream_data hal_stream_data_u;
typedef struct {
  int comp_id;
  int shmem_id;
  void* fifo;
} hal_stream_t;

/* `types` has a letter a column: b f s u l k. */
extern int hal_stream_create(hal_stream_t* stream, int comp_id, int key, unsigned depth,
                             const char* types);
extern void hal_stream_destroy(hal_stream_t* stream);
/* `types` null or "": whatever it has. */
extern int hal_stream_attach(hal_stream_t* stream, int comp_id, int key, const char* types);
extern void hal_stream_detach(hal_stream_t* stream);
/* From here on: realtime. */
extern int hal_stream_element_count(hal_stream_t* stream);
extern hal_type_t hal_stream_element_type(hal_stream_t* stream, int index);
/* One row; -ENOSPC: none there, or no room. */
extern int hal_stream_read(hal_stream_t* stream, hal_stream_data_u* row, unsigned* sampleno);
extern int hal_stream_write(hal_stream_t* stream, hal_stream_data_u* row);
extern bool hal_stream_readable(hal_stream_t* stream);
extern bool hal_stream_writable(hal_stream_t* stream);
extern int hal_stream_depth(hal_stream_t* stream);
extern unsigned hal_stream_maxdepth(hal_stream_t* stream);
extern int hal_stream_num_underruns(hal_stream_t* stream);
extern int hal_stream_num_overruns(hal_stream_t* stream);
#ifdef ULAPI
extern void hal_stream_wait_readable(hal_stream_t* stream, sig_atomic_t* stop);
extern void hal_stream_wait_writable(hal_stream_t* stream, sig_atomic_t* stop);
#endif

/* A counter of `nbits` bits has become `newlow`; the long counter that was `old`. realtime */
extern rtapi_s64 hal_extend_counter(rtapi_s64 old, rtapi_s64 newlow, int nbits);

/* ---- query ---- */

#ifdef ULAPI
typedef enum {
  HAL_QTYPE_ANY = 0,
  HAL_QTYPE_PIN,
  HAL_QTYPE_PARAM,
  HAL_QTYPE_SIGNAL,
  HAL_QTYPE_COMP,
  HAL_QTYPE_FUNCT,
  HAL_QTYPE_THREAD,
  HAL_QTYPE_THREAD_FUNCT
} hal_query_type_t;

typedef union {
  rtapi_bool b;
  rtapi_sint s;
  rtapi_uint u;
  rtapi_real r;
} hal_query_value_u;

typedef struct hal_query_t {
  const char* name;
  hal_query_type_t qtype;
  union {
    void* vpval;
    const char* cpval;
    int* ipval;
    unsigned* upval;
    rtapi_sint sival;
    rtapi_uint uival;
  } callerdata;
  union {
    struct {
      hal_type_t type;
      hal_refs_u ref;
      hal_query_value_u value;
      hal_pdir_t dir;
      const char* alias;  /* null: none */
      const char* signal; /* null: not linked */
      const char* comp;
      int comp_id;
    } pp; /* pins and parameters */
    struct {
      hal_type_t type;
      hal_refs_u ref;
      hal_query_value_u value;
      int writers, readers, bidirs;
    } sig;
    struct {
      int comp_id;
      hal_comp_type_t type;
      int pid;
      int ready;
      const char* insmod; /* null: not loaded by loadrt */
    } comp;
    struct {
      int comp_id;
      const char* comp;
      int users;
      hal_funct_t funct;
      void* arg;
      int reentrant;
    } funct;
    struct {
      int comp_id;
      const char* comp;
      int priority;
      long period;
      int functidx;      /* HAL_QTYPE_THREAD_FUNCT: which one of the thread */
      const char* funct; /* its name */
      int is_init;
    } thread;
  };
} hal_query_t;
/* Called for each answer; another value than 0 ends the list and is the call's value. The texts live until it returns. */
typedef int (*hal_query_cb)(hal_query_t* q, void* arg);

/* A pin or parameter (_p) or a signal (_s) by q->name. With a type in q that is not the item's: -EEXIST. -ENOENT: no such name.
   `cb` may be null. */
extern int hal_getref_p(hal_query_t* q);
extern int hal_get_p(hal_query_t* q, hal_query_cb cb, void* arg);
extern int hal_set_p(hal_query_t* q, hal_query_cb cb, void* arg); /* -EACCES: not writable */
extern int hal_getref_s(hal_query_t* q);
extern int hal_get_s(hal_query_t* q, hal_query_cb cb, void* arg);
/* A port's value is the size of its buffer (value.u). */
extern int hal_set_s(hal_query_t* q, hal_query_cb cb, void* arg);
/* All pins and parameters (q->qtype may ask for one kind); all pins of signal q->name; all signals, components, functions; all
   threads, each followed by its functions. */
extern int hal_list_p(hal_query_t* q, hal_query_cb cb, void* arg);
extern int hal_list_p_s(hal_query_t* q, hal_query_cb cb, void* arg);
extern int hal_list_s(hal_query_t* q, hal_query_cb cb, void* arg);
extern int hal_list_comp(hal_query_t* q, hal_query_cb cb, void* arg);
extern int hal_list_funct(hal_query_t* q, hal_query_cb cb, void* arg);
extern int hal_list_thread(hal_query_t* q, hal_query_cb cb, void* arg);
extern int hal_comp_by_name(const char* name, hal_query_t* q);
extern int hal_comp_by_id(int comp_id, hal_query_t* q);

typedef struct {
  unsigned long mem_total, mem_used, mem_free; /* bytes; free: of what was used before */
  int pins, params, signals, comps, functs, threads;
} hal_statistics_t;
extern int hal_statistics(hal_statistics_t* statistics);

/* Kept for sources that call them. No process can leave HAL locked, and periods are always exact: 0. */
extern int hal_mutex_force_release(void);
extern int hal_enforce_exact_base_period(void);
/* The text of what a component was loaded with, as `save` writes it; components loaded by loadrt have theirs: -EINVAL. */
extern int hal_comp_insmod_args(const char* comp, const char* args);
#endif /* ULAPI */

RTAPI_END_DECLS

#endif
