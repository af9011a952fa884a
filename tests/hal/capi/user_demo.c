/* A program with pins and parameters of all types. It waits for demo.go, then (with the argument "die" it kills itself there) adds up what it sees, reads the stream and the shared
   memory of the realtime components, and says what it found. */
#include <hal.h>
#include <pthread.h>
#include <rtapi.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define SHM_KEY 0x4b455246
#define STREAM_KEY 0x4b455247

struct data {
  hal_bit_t* go;
  hal_float_t* in;
  hal_float_t* out;
  hal_s32_t* s;
  hal_u32_t* u;
  hal_s64_t* ls;
  hal_u64_t* lu;
  hal_port_t* text;
  hal_float_t gain;
  hal_s32_t ps;
  hal_u32_t pu;
  hal_bit_t pb;
};

static struct data* d;
static int id;

static void* second_thread(void* arg) {
  int i, bad = 0;
  (void)arg;
  for (i = 0; i < 50; i++) {
    hal_type_t type;
    hal_data_u* value;
    bool connected;
    if (hal_get_pin_value_by_name("demo.in", &type, &value, &connected) != 0) bad++;
  }
  return bad ? "bad" : NULL;
}

static int count_pins(hal_query_t* q, void* arg) {
  if (q->pp.comp_id == id) ++*(int*)arg;
  return 0;
}

static int show_pin(hal_query_t* q, void* arg) {
  (void)arg;
  printf("query: %s type %d dir %d value %g signal %s owner %s\n", q->name, q->pp.type, q->pp.dir,
         q->pp.value.r, q->pp.signal ? q->pp.signal : "-", q->pp.comp);
  return 0;
}

static int fails(const char* what) {
  printf("failed: %s\n", what);
  fflush(stdout);
  return 1;
}

int main(int argc, char** argv) {
  int waited, pins = 0, shm, status;
  void* thread_result;
  struct { int calls; }* shared;
  hal_stream_t stream;
  hal_stream_data_u row[3];
  unsigned sample = 0;
  hal_query_t q;
  pthread_t thread;
  pid_t child;
  id = hal_init("demo");
  if (id < 0) return fails("hal_init");
  d = hal_malloc(sizeof *d);
  if (!d) return fails("hal_malloc");
  if (hal_pin_bit_new("demo.go", HAL_IN, &d->go, id) || hal_pin_float_new("demo.in", HAL_IN, &d->in, id) ||
      hal_pin_float_newf(HAL_OUT, &d->out, id, "demo.%s", "out") || hal_pin_s32_new("demo.s", HAL_OUT, &d->s, id) ||
      hal_pin_u32_new("demo.u", HAL_OUT, &d->u, id) || hal_pin_s64_new("demo.ls", HAL_OUT, &d->ls, id) ||
      hal_pin_u64_new("demo.lu", HAL_OUT, &d->lu, id) || hal_pin_port_new("demo.text", HAL_OUT, &d->text, id))
    return fails("pins");
  if (hal_param_float_new("demo.gain", HAL_RW, &d->gain, id) || hal_param_s32_new("demo.ps", HAL_RO, &d->ps, id) ||
      hal_param_u32_new("demo.pu", HAL_RW, &d->pu, id) || hal_param_bit_newf(HAL_RW, &d->pb, id, "demo.pb"))
    return fails("params");
  *d->out = 1.25;
  *d->s = -5;
  *d->u = 4000000000U;
  *d->ls = -9000000000000000000LL;
  *d->lu = 18000000000000000000ULL;
  d->gain = 2.0;
  d->ps = -2;
  if (hal_ready(id) != 0) return fails("hal_ready");
  for (waited = 0; !*d->go; waited++) {
    struct timespec pause = {0, 2000000};
    if (waited > 15000) return fails("demo.go never came");
    nanosleep(&pause, NULL);
  }
  if (argc > 1 && strcmp(argv[1], "die") == 0) raise(SIGKILL);
  /* The realtime component has started by the same signal; its output comes a cycle later. */
  for (waited = 0; *d->in == 0; waited++) {
    struct timespec pause = {0, 2000000};
    if (waited > 15000) return fails("demo.in never came");
    nanosleep(&pause, NULL);
  }
  *d->out = *d->in * d->gain;
  d->ps = 42;
  printf("in %g gain %g pu %u pb %d\n", *d->in, d->gain, d->pu, d->pb);
  printf("port %u: wrote %d\n", hal_port_buffer_size(d->text), hal_port_write(d->text, "kerf", 4));

  if (pthread_create(&thread, NULL, second_thread, NULL) != 0) return fails("thread");
  hal_list_p(&(hal_query_t){.qtype = HAL_QTYPE_PIN}, count_pins, &pins);
  pthread_join(thread, &thread_result);
  printf("threads: %s, pins %d\n", thread_result ? (char*)thread_result : "fine", pins);

  child = fork();
  if (child == 0) _exit(hal_ready(id) == -EPERM && hal_malloc(8) == NULL ? 0 : 1);
  waitpid(child, &status, 0);
  printf("child: %s\n", WIFEXITED(status) && WEXITSTATUS(status) == 0 ? "refused" : "not refused");

  memset(&q, 0, sizeof q);
  q.name = "demo.in";
  printf("get_p %d\n", hal_get_p(&q, show_pin, NULL));
  q.pp.type = HAL_S32;
  printf("get_p of another type %d\n", hal_get_p(&q, NULL, NULL));
  memset(&q, 0, sizeof q);
  q.name = "rt_demo.0.biggest";
  q.pp.value.s = 1LL << 40;
  printf("set_p %d", hal_set_p(&q, NULL, NULL));
  printf(" -> %lld, through its reference %lld\n", (long long)q.pp.value.s, (long long)hal_get_sint(q.pp.ref.s));
  memset(&q, 0, sizeof q);
  q.name = "rt_demo.0.out";
  printf("set_p of an output %d\n", hal_set_p(&q, NULL, NULL));
  memset(&q, 0, sizeof q);
  q.name = "nothing";
  printf("set_p of nothing %d\n", hal_set_p(&q, NULL, NULL));
  memset(&q, 0, sizeof q);
  q.name = "level";
  printf("get_s %d", hal_get_s(&q, NULL, NULL));
  printf(" writers %d readers %d value %g\n", q.sig.writers, q.sig.readers, q.sig.value.r);
  printf("comp %d", hal_comp_by_name("rt_demo", &q));
  printf(" type %d ready %d\n", q.comp.type, q.comp.ready);

  shm = rtapi_shmem_new(SHM_KEY, id, sizeof *shared);
  if (shm < 0 || rtapi_shmem_getptr(shm, (void**)&shared) != 0) return fails("shared memory");
  /* The realtime side takes the four letters from the port and counts a million. */
  for (waited = 0; shared->calls < 1000000; waited++) {
    struct timespec pause = {0, 2000000};
    if (waited > 15000) return fails("the port's text never came");
    nanosleep(&pause, NULL);
  }
  printf("shared memory: counted\n");
  if (hal_stream_attach(&stream, id, STREAM_KEY, "sfb") != 0) return fails("stream");
  hal_stream_wait_readable(&stream, NULL);
  if (hal_stream_read(&stream, row, &sample) != 0) return fails("stream row");
  printf("stream: %d columns, sample %u, %d %g %d\n", hal_stream_element_count(&stream), sample, row[0].s, row[1].f, row[2].b);
  hal_stream_detach(&stream);
  printf("no such type: %d\n", hal_stream_attach(&stream, id, STREAM_KEY, "bbb"));
  rtapi_shmem_delete(shm, id);
  fflush(stdout);
  printf("exit %d\n", hal_exit(id));
  fflush(stdout);
  FILE* ended = fopen("user_demo.ended", "w");  // for ./ended
  if (ended != NULL) fclose(ended);
  return 0;
}
