/* A user-space part of rt_driver, by polling: looks into its shared memory, reads its stream, talks over its ports. */
#include <hal.h>
#include <rtapi.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

static int show_funct(hal_query_t* q, void* arg) {
  (void)arg;
  if (strncmp(q->name, "rt_driver.", 10) == 0)
    printf("function %s of %s: users %d reentrant %d\n", q->name, q->funct.comp, q->funct.users, q->funct.reentrant);
  return 0;
}

static int show_thread(hal_query_t* q, void* arg) {
  (void)arg;
  if (q->qtype == HAL_QTYPE_THREAD)
    printf("thread %s period %ld priority %s\n", q->name, q->thread.period, q->thread.priority > 0 ? "yes" : "none");
  else
    printf("  %d %s init %d\n", q->thread.functidx, q->thread.funct, q->thread.is_init);
  return 0;
}

int main(void) {
  const struct timespec pause = {0, 1000000};
  struct { unsigned long lock; unsigned magic, boards; unsigned long long cycles; }* shared;
  void* memory;
  hal_query_t q;
  hal_stream_t stream;
  hal_stream_data_u row[3];
  unsigned number;
  struct { hal_port_t *tx, *rx; } *ports;
  char text[32] = "";
  sig_atomic_t stop = 0;
  int shmem, i;
  const int comp = hal_init("board_panel");
  if (comp < 0) return 1;
  ports = hal_malloc(sizeof *ports);
  hal_pin_port_new("board_panel.tx", HAL_OUT, &ports->tx, comp);
  hal_pin_port_new("board_panel.rx", HAL_IN, &ports->rx, comp);
  hal_ready(comp);
  shmem = rtapi_shmem_new(0x44524956, comp, sizeof *shared);
  if (shmem < 0 || rtapi_shmem_getptr(shmem, &memory) != 0) return 2;
  shared = memory;
  printf("magic %x boards %u\n", shared->magic, shared->boards);
  memset(&q, 0, sizeof q);
  hal_list_funct(&q, show_funct, NULL);
  memset(&q, 0, sizeof q);
  hal_list_thread(&q, show_thread, NULL);
  if (hal_stream_attach(&stream, comp, 0x52540001, "ufb") < 0) return 3;
  for (i = 0; i < 3; i++) {
    hal_stream_wait_readable(&stream, &stop);
    if (hal_stream_read(&stream, row, &number) < 0) return 4;
    printf("row %u: %u %.3f %d\n", number, row[0].u, row[1].f, row[2].b);
  }
  hal_stream_detach(&stream);
  for (i = 0; i < 5000 && hal_port_buffer_size(ports->tx) == 0; i++) nanosleep(&pause, NULL);
  if (!hal_port_write(ports->tx, "hello board", 11)) return 5;
  hal_port_wait_readable(&ports->rx, 11, &stop);
  if (!hal_port_read(ports->rx, text, 11)) return 6;
  printf("answer '%s'\n", text);
  printf("cycles %s\n", shared->cycles >= 30 ? "counted" : "lost");
  rtapi_shmem_delete(shmem, comp);
  fflush(stdout);  /* before waitusr goes on */
  hal_exit(comp);
  return 0;
}
