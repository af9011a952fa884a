/* A realtime component as integrators write them: instances by count= or names=, pins in a struct from hal_malloc, parameters of
   every type, a function for each instance, shared memory, a port. */
#include <hal.h>
#include <rtapi.h>
#include <rtapi_app.h>
#include <rtapi_errno.h>
#include <rtapi_math.h>
#include <rtapi_string.h>

MODULE_AUTHOR("Kerf");
MODULE_DESCRIPTION("Test component of the C API");
MODULE_LICENSE("GPL");

#define MOST 8
#define SHM_KEY 0x4b455246

static int count = 0;
RTAPI_MP_INT(count, "number of instances");
static char* names[MOST];
RTAPI_MP_ARRAY_STRING(names, MOST, "names of the instances");
static long offset = 0;
RTAPI_MP_LONG(offset, "added to every sum");
static int gains[MOST] = {1, 1, 1, 1, 1, 1, 1, 1};
RTAPI_MP_ARRAY_INT(gains, MOST, "gain of each instance");
static char* mood = "calm";
RTAPI_MP_STRING(mood, "said at start");
static int share = 1;
RTAPI_MP_INT(share, "0: without shared memory, which other processes may go on using");
static int fail = 0;
RTAPI_MP_INT(fail, "error number that rtapi_app_main gives after it made everything");

typedef struct {
  hal_bit_t* enable;
  hal_float_t* in;
  hal_float_t* out;
  hal_s32_t* counts;
  hal_u32_t* cycles;
  hal_s64_t* far;
  hal_u64_t* mask;
  hal_bit_t* index;
  hal_float_t scale;
  hal_s32_t low;
  hal_u32_t high;
  hal_bit_t inverted;
  hal_s64_t biggest;
  hal_u64_t seen;
} instance_t;

struct shared {
  int calls;
};

static int comp_id;
static int how_many;
static instance_t* instances;
static hal_port_t** port;
static int shm_id;
static struct shared* shared;

static void update(void* arg, long period) {
  instance_t* it = arg;
  (*it->cycles)++;
  if (it == instances && shared) shared->calls++;
  if (!*it->enable) return;
  *it->out = *it->in * it->scale + (double)offset;
  *it->counts = (rtapi_s32)floor(*it->out);
  *it->far = (rtapi_s64)*it->counts * 1000000000LL;
  *it->mask = ~(rtapi_u64)0;
  if (*it->index) *it->index = 0;
  it->seen += (rtapi_u64)(period > 0);
  it->inverted = !it->inverted;
}

static void chatter(void* arg, long period) {
  static int said;
  (void)arg;
  (void)period;
  if (!said) rtapi_print_msg(RTAPI_MSG_ERR, "rt_demo: %s and running, pi is %.5f\n", mood, M_PI);
  said = 1;
  if (hal_port_readable(*port) >= 4) {
    char text[4];
    if (hal_port_read(*port, text, 4)) shared->calls += text[0] == 'k' ? 1000000 : 0;
  }
}

static int export_one(int i, const char* prefix) {
  instance_t* it = &instances[i];
  int r;
  it->scale = gains[i];
  if ((r = hal_pin_bit_newf(HAL_IN, &it->enable, comp_id, "%s.enable", prefix)) != 0) return r;
  if ((r = hal_pin_float_newf(HAL_IN, &it->in, comp_id, "%s.in", prefix)) != 0) return r;
  if ((r = hal_pin_float_newf(HAL_OUT, &it->out, comp_id, "%s.out", prefix)) != 0) return r;
  if ((r = hal_pin_s32_newf(HAL_OUT, &it->counts, comp_id, "%s.counts", prefix)) != 0) return r;
  if ((r = hal_pin_u32_newf(HAL_OUT, &it->cycles, comp_id, "%s.cycles", prefix)) != 0) return r;
  if ((r = hal_pin_s64_newf(HAL_OUT, &it->far, comp_id, "%s.far", prefix)) != 0) return r;
  if ((r = hal_pin_u64_newf(HAL_OUT, &it->mask, comp_id, "%s.mask", prefix)) != 0) return r;
  if ((r = hal_pin_bit_newf(HAL_IO, &it->index, comp_id, "%s.index-enable", prefix)) != 0) return r;
  if ((r = hal_param_float_newf(HAL_RW, &it->scale, comp_id, "%s.scale", prefix)) != 0) return r;
  if ((r = hal_param_s32_newf(HAL_RW, &it->low, comp_id, "%s.low", prefix)) != 0) return r;
  if ((r = hal_param_u32_newf(HAL_RW, &it->high, comp_id, "%s.high", prefix)) != 0) return r;
  if ((r = hal_param_bit_newf(HAL_RO, &it->inverted, comp_id, "%s.inverted", prefix)) != 0) return r;
  if ((r = hal_param_s64_newf(HAL_RW, &it->biggest, comp_id, "%s.biggest", prefix)) != 0) return r;
  if ((r = hal_param_u64_newf(HAL_RO, &it->seen, comp_id, "%s.seen", prefix)) != 0) return r;
  return hal_export_functf(update, it, 1, 0, comp_id, "%s.update", prefix);
}

int rtapi_app_main(void) {
  int i, r;
  for (how_many = 0; how_many < MOST && names[how_many]; how_many++);
  if (count && how_many) {
    rtapi_print_msg(RTAPI_MSG_ERR, "count= and names= are mutually exclusive\n");
    return -EINVAL;
  }
  if (!how_many) how_many = count ? count : 1;
  comp_id = hal_init("rt_demo");
  if (comp_id < 0) return comp_id;
  instances = hal_malloc(how_many * (long)sizeof(instance_t));
  port = hal_malloc(sizeof *port);
  if (!instances || !port) goto failed;
  for (i = 0; i < how_many; i++) {
    char prefix[HAL_NAME_LEN + 1];
    if (names[i])
      rtapi_snprintf(prefix, sizeof prefix, "%s", names[i]);
    else
      rtapi_snprintf(prefix, sizeof prefix, "rt_demo.%d", i);
    if ((r = export_one(i, prefix)) != 0) goto failed;
  }
  if ((r = hal_pin_port_new("rt_demo.text", HAL_IN, port, comp_id)) != 0) goto failed;
  if ((r = hal_export_funct("rt_demo.chatter", chatter, NULL, 1, 0, comp_id)) != 0) goto failed;
  if (share) shm_id = rtapi_shmem_new(SHM_KEY, comp_id, sizeof(struct shared));
  if (share && (shm_id < 0 || rtapi_shmem_getptr(shm_id, (void**)&shared) != 0)) goto failed;
  if (fail) {
    /* Without hal_exit: the loader takes everything back. */
    return -fail;
  }
  hal_ready(comp_id);
  return 0;
failed:
  hal_exit(comp_id);
  return -EINVAL;
}

void rtapi_app_exit(void) {
  if (share) rtapi_shmem_delete(shm_id, comp_id);
  hal_exit(comp_id);
}
