/* A driver as vendors write them: boards named in array parameters, a table of pins made in a loop, read and write functions for each
   board, times from the RTAPI clock, statistics in shared memory, a port for text, a stream of records. */
#include <hal.h>
#include <rtapi.h>
#include <rtapi_app.h>
#include <rtapi_math.h>
#include <rtapi_mutex.h>
#include <rtapi_slab.h>
#include <rtapi_string.h>

MODULE_AUTHOR("Kerf");
MODULE_DESCRIPTION("Driver of boards that are not there");
MODULE_LICENSE("GPL");

#define MAX_BOARDS 4
#define NAME "rt_driver"
#define SHMEM_KEY 0x44524956
#define STREAM_KEY 0x52540001

static char* board[MAX_BOARDS];
RTAPI_MP_ARRAY_STRING(board, MAX_BOARDS, "names of the boards");
static int channels[MAX_BOARDS] = {2, 2, 2, 2};
RTAPI_MP_ARRAY_INT(channels, MAX_BOARDS, "channels of each board");
static int timeout_ms = 10;
RTAPI_MP_INT(timeout_ms, "time until the watchdog bites");
static char* mode = "normal";
RTAPI_MP_STRING(mode, "normal or raw");
static char* init_thread = "";
RTAPI_MP_STRING(init_thread, "thread that runs the last board's write function once");

typedef struct {
  hal_float_t *value, *raw;
  hal_bit_t* index;
  hal_float_t scale;
  hal_s32_t offset;
} channel_t;

typedef struct {
  hal_bit_t *watchdog, *enable;
  hal_u32_t *reads, *writes;
  hal_s64_t* age;
  hal_port_t *tx, *rx;
  hal_u32_t errors;
  long long last;
  int channels;
  int number;
  channel_t* channel;
} board_t;

/* What user-space programs see of the driver. */
typedef struct {
  unsigned long lock;
  unsigned magic;
  unsigned boards;
  unsigned long long cycles;
} shared_t;

static int comp_id, shmem_id, boards;
static board_t* table;
static shared_t* shared;
static hal_stream_t stream;
static int with_stream;

static void read_board(void* arg, long period) {
  board_t* b = arg;
  int i;
  const long long now = rtapi_get_time();
  if (b->last == 0) b->last = now;
  *b->age = now - b->last;
  if (*b->enable) b->last = now;
  *b->watchdog = *b->age > (long long)timeout_ms * 1000000;
  for (i = 0; i < b->channels; i++) {
    channel_t* c = &b->channel[i];
    *c->raw += period * 1e-9 * (i + 1);
    *c->value = (*c->raw + c->offset) * c->scale;
    if (*c->index) *c->index = 0, *c->raw = 0;
  }
  ++*b->reads;
  if (rtapi_mutex_try(&shared->lock) == 0) {
    shared->cycles++;
    rtapi_mutex_give(&shared->lock);
  }
  if (with_stream && b->number == 0 && *b->reads % 10 == 0) {
    hal_stream_data_u row[3];
    row[0].u = *b->reads;
    row[1].f = floor(*b->channel[0].raw * 1000 + 0.5) / 1000;
    row[2].b = *b->watchdog;
    if (hal_stream_write(&stream, row) < 0) b->errors++;
  }
}

static void write_board(void* arg, long period) {
  board_t* b = arg;
  char text[16];
  unsigned n = hal_port_readable(b->rx);
  (void)period;
  if (n > sizeof text) n = sizeof text;
  /* What comes on one port goes out of the other in capitals. */
  if (n > 0 && hal_port_writable(b->tx) >= n && hal_port_read(b->rx, text, n)) {
    unsigned i;
    for (i = 0; i < n; i++)
      if (text[i] >= 'a' && text[i] <= 'z') text[i] -= 'a' - 'A';
    if (!hal_port_write(b->tx, text, n)) b->errors++;
  }
  ++*b->writes;
}

static int export_channel(const char* name, int i, channel_t* c) {
  int r = hal_pin_float_newf(HAL_OUT, &c->value, comp_id, NAME ".%s.%02d.value", name, i);
  if (r == 0) r = hal_pin_float_newf(HAL_OUT, &c->raw, comp_id, NAME ".%s.%02d.raw", name, i);
  if (r == 0) r = hal_pin_bit_newf(HAL_IO, &c->index, comp_id, NAME ".%s.%02d.index-enable", name, i);
  if (r == 0) r = hal_param_float_newf(HAL_RW, &c->scale, comp_id, NAME ".%s.%02d.scale", name, i);
  if (r == 0) r = hal_param_s32_newf(HAL_RW, &c->offset, comp_id, NAME ".%s.%02d.offset", name, i);
  c->scale = 1;
  return r;
}

static int export_board(const char* name, board_t* b) {
  char funct[HAL_NAME_LEN + 1];
  int r, i;
  b->channel = hal_malloc(b->channels * (long)sizeof(channel_t));
  if (b->channel == NULL) return -ENOMEM;
  memset(b->channel, 0, b->channels * sizeof(channel_t));
  for (i = 0; i < b->channels; i++)
    if ((r = export_channel(name, i, &b->channel[i])) != 0) return r;
  r = hal_pin_bit_newf(HAL_OUT, &b->watchdog, comp_id, NAME ".%s.watchdog", name);
  if (r == 0) r = hal_pin_bit_newf(HAL_IN, &b->enable, comp_id, NAME ".%s.enable", name);
  if (r == 0) r = hal_pin_u32_newf(HAL_OUT, &b->reads, comp_id, NAME ".%s.reads", name);
  if (r == 0) r = hal_pin_u32_newf(HAL_OUT, &b->writes, comp_id, NAME ".%s.writes", name);
  if (r == 0) r = hal_pin_s64_newf(HAL_OUT, &b->age, comp_id, NAME ".%s.age", name);
  if (r == 0) r = hal_pin_port_newf(HAL_OUT, &b->tx, comp_id, NAME ".%s.tx", name);
  if (r == 0) r = hal_pin_port_newf(HAL_IN, &b->rx, comp_id, NAME ".%s.rx", name);
  if (r == 0) r = hal_param_u32_newf(HAL_RO, &b->errors, comp_id, NAME ".%s.errors", name);
  if (r != 0) return r;
  rtapi_snprintf(funct, sizeof funct, NAME ".%s.read", name);
  r = hal_export_funct(funct, read_board, b, 1, 0, comp_id);
  if (r == 0) r = hal_export_functf(write_board, b, 0, 1, comp_id, NAME ".%s.write", name);
  return r;
}

int rtapi_app_main(void) {
  int i, r;
  void* memory;
  if (strcmp(mode, "normal") != 0 && strcmp(mode, "raw") != 0) {
    rtapi_print_msg(RTAPI_MSG_ERR, NAME ": ERROR: mode '%s' is not known\n", mode);
    return -EINVAL;
  }
  while (boards < MAX_BOARDS && board[boards] != NULL) boards++;
  if (boards == 0) {
    rtapi_print_msg(RTAPI_MSG_ERR, NAME ": ERROR: no boards configured\n");
    return -ENODEV;
  }
  comp_id = hal_init(NAME);
  if (comp_id < 0) return comp_id;
  table = hal_malloc(boards * (long)sizeof(board_t));
  if (table == NULL) {
    hal_exit(comp_id);
    return -ENOMEM;
  }
  memset(table, 0, boards * sizeof(board_t));
  for (i = 0; i < boards; i++) {
    table[i].number = i;
    table[i].channels = channels[i];
    if ((r = export_board(board[i], &table[i])) != 0) {
      rtapi_print_msg(RTAPI_MSG_ERR, NAME ": ERROR: board %s: %d\n", board[i], r);
      hal_exit(comp_id);
      return r;
    }
  }
  shmem_id = rtapi_shmem_new(SHMEM_KEY, comp_id, sizeof(shared_t));
  if (shmem_id < 0 || rtapi_shmem_getptr(shmem_id, &memory) != 0) {
    hal_exit(comp_id);
    return -ENOMEM;
  }
  shared = memory;
  if (shared->magic == 0) shared->magic = 0xb0a2d5;
  shared->boards = boards;
  with_stream = strcmp(mode, "raw") == 0;
  if (with_stream && (r = hal_stream_create(&stream, comp_id, STREAM_KEY, 8192, "ufb")) < 0) {
    hal_exit(comp_id);
    return r;
  }
  if (*init_thread != 0) {
    char funct[HAL_NAME_LEN + 1];
    rtapi_snprintf(funct, sizeof funct, NAME ".%s.write", board[boards - 1]);
    if ((r = hal_init_funct_to_thread(funct, init_thread, 1)) != 0) {
      hal_exit(comp_id);
      return r;
    }
  }
  hal_ready(comp_id);
  return 0;
}

void rtapi_app_exit(void) {
  if (with_stream) hal_stream_destroy(&stream);
  /* The shared memory is forgotten, as some do. */
  hal_exit(comp_id);
}
