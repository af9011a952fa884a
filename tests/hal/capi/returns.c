/* What each call gives, and what it says on stderr, for the right use and for each wrong one. Compiles against LinuxCNC's headers
   too, so that both can be compared. */
#include <stdio.h>
#include <string.h>
#include <stdlib.h>
#include <rtapi.h>
#include <hal.h>
#if HAL_NAME_LEN < 55 /* an older one, whose ports are given by value */
#define PORT(p) (*(p))
#else
#define PORT(p) (p)
#endif
#define R(e) do { int r_ = (int)(e); fflush(stderr); printf("%-70s -> %d\n", #e, r_); fflush(stdout);} while(0)
struct d { hal_bit_t *a; hal_float_t *f; hal_s32_t *s; hal_u32_t *u; hal_port_t *po; hal_bit_t *x, *y, *z[16]; hal_s32_t p; hal_float_t pf; hal_bit_t pb; hal_u32_t pu; };
int main(void) {
  setvbuf(stderr, 0, _IONBF, 0);
  int id = hal_init("k"); printf("init %d\n", id > 0);
  R(hal_init("k")); 
  R(hal_init("0123456789012345678901234567890123456789012345678901234567890123456789"));
  R(hal_init(NULL));
  struct d *d = hal_malloc(sizeof *d); memset((void*)d, 0, sizeof *d);
  R(hal_pin_bit_new("k.a", HAL_IN, &d->a, id));
  printf("cell set %d value %d\n", d->a != 0, *d->a);
  R(hal_pin_bit_new("k.a", HAL_IN, &d->z[0], id));
  R(hal_pin_bit_new("k.a2", HAL_IN, &d->a, id));
  R(hal_pin_bit_new("k.b", HAL_RO, &d->z[1], id));
  R(hal_pin_bit_new("k.b", HAL_IN, &d->z[2], 9999));
  { static hal_bit_t *local; R(hal_pin_bit_new("k.b", HAL_IN, &local, id)); }
  R(hal_pin_bit_new("k.0123456789012345678901234567890123456789012345678901234567890123456789", HAL_IN, &d->z[3], id));
  R(hal_pin_bit_newf(HAL_IN, &d->z[4], id, "k.%s", "0123456789012345678901234567890123456789012345678901234567890123456789"));
  R(hal_pin_new("k.t", 99, HAL_IN, (void**)&d->z[5], id));
  R(hal_pin_float_newf(HAL_OUT, &d->f, id, "k.%d.f", 3));
  R(hal_pin_s32_new("k.s", HAL_IO, &d->s, id));
  R(hal_pin_u32_new("k.u", HAL_OUT, &d->u, id));
  R(hal_pin_port_new("k.po", HAL_OUT, &d->po, id));
  R(hal_pin_port_new("k.pio", HAL_IO, (hal_port_t**)&d->z[6], id));
  R(hal_param_s32_new("k.p", HAL_RW, &d->p, id));
  R(hal_param_s32_new("k.p", HAL_RW, &d->p, id));
  R(hal_param_s32_new("k.p2", HAL_IN, &d->p, id));
  R(hal_param_float_newf(HAL_RO, &d->pf, id, "k.pf"));
  R(hal_param_bit_new("k.pb", HAL_RW, &d->pb, id));
  R(hal_param_u32_new("k.pu", HAL_RW, &d->pu, id));
  { static hal_s32_t local; R(hal_param_s32_new("k.p3", HAL_RW, &local, id)); }
  R(hal_param_s32_new("k.p4", HAL_RW, &d->p, 9999));
  R(hal_param_s32_set("k.p", 5)); printf("p=%d\n", d->p);
  R(hal_param_s32_set("k.pf", 5));
  R(hal_param_float_set("k.pf", 2.5)); printf("pf=%g\n", d->pf);
  R(hal_param_float_set("k.p", 2.5));
  R(hal_param_bit_set("k.pb", 7)); printf("pb=%d\n", d->pb);
  R(hal_param_u32_set("k.pu", 4000000000UL)); printf("pu=%u\n", d->pu);
  R(hal_param_s32_set("k.nope", 5));
  R(hal_signal_new("s", HAL_BIT));
  R(hal_signal_new("s", HAL_BIT));
  R(hal_signal_new("sf", HAL_FLOAT));
  R(hal_signal_new("st", 42));
  R(hal_signal_new("k.a", HAL_BIT));
  R(hal_signal_new("0123456789012345678901234567890123456789012345678901234567890123456789", HAL_BIT));
  R(hal_link("k.a", "s"));
  R(hal_link("k.a", "s"));
  R(hal_link("k.a", "nosig"));
  R(hal_link("nopin", "s"));
  R(hal_signal_new("s2", HAL_BIT));
  R(hal_link("k.a", "s2"));
  R(hal_link("k.s", "sf"));
  R(hal_link("k.3.f", "sf"));
  R(hal_unlink("k.a"));
  R(hal_unlink("k.a"));
  R(hal_unlink("nopin"));
  R(hal_signal_delete("nosig"));
  R(hal_signal_delete("s2"));
  R(hal_pin_alias("k.a", "al"));
  R(hal_pin_alias("nopin", "al"));
  R(hal_pin_alias("k.s", "al"));
  R(hal_pin_alias("k.a", NULL));
  R(hal_param_alias("k.p", "pal"));
  R(hal_param_alias("nope", "pal"));
  R(hal_param_alias("k.p", NULL));
  { hal_type_t t = -5; hal_data_u *v = 0; bool b = 0;
    R(hal_get_pin_value_by_name("k.a", &t, &v, &b)); printf("type %d conn %d\n", t, b);
    R(hal_get_pin_value_by_name("k.nope", &t, &v, &b));
    R(hal_get_signal_value_by_name("sf", &t, &v, &b)); printf("type %d writers %d\n", t, b);
    R(hal_get_signal_value_by_name("nosig", &t, &v, &b));
    R(hal_get_param_value_by_name("k.p", &t, &v)); printf("type %d v %d\n", t, v ? v->s : -1);
    R(hal_get_param_value_by_name("nope", &t, &v)); }
  R(hal_add_funct_to_thread("nof", "not", 1));
  R(hal_add_funct_to_thread("nof", "not", 0));
  R(hal_del_funct_from_thread("nof", "not"));
  R(hal_start_threads()); R(hal_stop_threads());
  R(strcmp(hal_comp_name(id), "k")); printf("comp name of unknown %p\n", (void*)hal_comp_name(9999));
  R(hal_ready(9999));
  R(hal_ready(id)); R(hal_ready(id));
  R(hal_pin_bit_new("k.late", HAL_IN, &d->y, id));
  R(hal_param_s32_new("k.latep", HAL_RW, &d->p, id));
  R(hal_unready(id)); R(hal_unready(id)); R(hal_unready(9999));
  R(hal_pin_bit_new("k.late", HAL_IN, &d->y, id));
  R(hal_ready(id));
  R(hal_set_lock(HAL_LOCK_ALL)); R(hal_get_lock());
  R(hal_pin_bit_new("k.l", HAL_IN, &d->y, id));
  R(hal_signal_new("z", HAL_BIT)); R(hal_signal_delete("s")); R(hal_link("k.a", "s")); R(hal_unlink("k.a"));
  R(hal_param_s32_set("k.p", 5)); R(hal_start_threads()); R(hal_stop_threads()); R(hal_add_funct_to_thread("f", "t", 1)); R(hal_del_funct_from_thread("f", "t"));
  R(hal_pin_alias("k.a", "q")); R(hal_param_alias("k.p", "q")); R(hal_init("k2") > 0); R(hal_malloc(10) == NULL);
  R(hal_set_lock(0));
  R(hal_malloc(0) == NULL); R(hal_malloc(100000000) == NULL);
  { int key = 0x1234, m = id, sh; void *p = 0; R((sh = rtapi_shmem_new(key, m, 1000)) > 0); R(rtapi_shmem_getptr(sh, &p)); printf("p %d\n", p != 0);
    R(rtapi_shmem_new(key, m, 1000) == sh); R(rtapi_shmem_new(key, m, 100000)); R(rtapi_shmem_getptr(99, &p)); R(rtapi_shmem_delete(99, m)); R(rtapi_shmem_delete(sh, 999)); R(rtapi_shmem_delete(sh, m)); R(rtapi_shmem_delete(sh, m)); R(rtapi_shmem_new(0, m, 10)); }
  R(rtapi_get_msg_level()); R(rtapi_set_msg_level(9)); R(rtapi_get_msg_level()); R(rtapi_set_msg_level(1)); R(rtapi_is_kernelspace()); 
  R(rtapi_init("rt") > 0); R(rtapi_exit(9999));
  { char b[64]; memset(b, 'x', 64); R(rtapi_snprintf(b, 8, "hello %s", "world")); printf("[%s]\n", b); R(rtapi_snprintf(b, 64, "%d %5d|%-5d|%05d %x %X %#x %o %c %s %.3s %10s|%-10s|%%", -3, 42, 42, 42, 255, 255, 255, 8, 'c', "str", "abcdef", "r", "l")); printf("[%s]\n", b);
    R(rtapi_snprintf(b, 64, "%f %g %e %.2f", 1.5, 2.5, 1e10, 3.14159)); printf("[%s]\n", b); R(rtapi_snprintf(b, 64, "%ld %lu %lld %lx %p", -5L, 6UL, 1LL<<40, 255L, (void*)0x1234)); printf("[%s]\n", b); R(rtapi_snprintf(b, 64, "%*d|%-*d|%hd %hhd %zu", 5, 3, 5, 3, 7, 8, (size_t)9)); printf("[%s]\n", b);
    R(rtapi_snprintf(b, 64, "%f|%a|%s|%+d|% d", 0.1, 0.1, (char*)0, 5, 5)); printf("[%s]\n", b); R(rtapi_snprintf(NULL, 0, "abc")); }
  rtapi_print("print %d\n", 5); rtapi_print_msg(RTAPI_MSG_ERR, "err %d\n", 6); rtapi_print_msg(RTAPI_MSG_WARN, "warn %d\n", 6); rtapi_print_msg(RTAPI_MSG_ERR, "float %f\n", 0.5);
  { hal_stream_t st, st2; R(hal_stream_create(&st, id, 0x77, 4, "bfsu")); R(hal_stream_element_count(&st)); R(hal_stream_element_type(&st, 0)); R(hal_stream_element_type(&st, 1)); R(hal_stream_element_type(&st, 9)); R(hal_stream_depth(&st)); R(hal_stream_maxdepth(&st)); R(hal_stream_readable(&st)); R(hal_stream_writable(&st));
    R(hal_stream_attach(&st2, id, 0x77, "bf")); R(hal_stream_attach(&st2, id, 0x77, "BFSU")); 
    union hal_stream_data w[4], r[4]; memset(w, 0, sizeof w); w[0].b = 1; w[1].f = 2.5; w[2].s = -3; w[3].u = 4; unsigned n = 77;
    R(hal_stream_read(&st, r, &n)); R(hal_stream_num_underruns(&st));
    for (int i = 0; i < 6; i++) R(hal_stream_write(&st, w)); R(hal_stream_depth(&st)); R(hal_stream_num_overruns(&st)); R(hal_stream_read(&st, r, &n)); printf("n %u f %g s %d u %u b %d\n", n, r[1].f, r[2].s, r[3].u, r[0].b); R(hal_stream_write(&st, w)); for (int i = 0; i < 4; i++) { R(hal_stream_read(&st, r, &n)); printf("n %u\n", n); }
    R(hal_stream_create(&st2, id, 0x78, 4, "bz")); R(hal_stream_create(&st2, id, 0x78, 4, "bbbbbbbbbbbbbbbbbbbbbbbbbbbbbbb")); R(hal_stream_attach(&st2, id, 0x79, "bf")); 
    hal_stream_destroy(&st); }
  { char b[20]; R(hal_port_readable(PORT(d->po))); R(hal_port_writable(PORT(d->po))); R(hal_port_buffer_size(PORT(d->po))); R(hal_port_write(PORT(d->po), "abc", 3)); R(hal_port_read(PORT(d->po), b, 3)); R(hal_port_read(PORT(d->po), b, 0)); }
  R(hal_exit(9999)); R(hal_exit(id)); R(hal_exit(id)); R(hal_ready(id)); R(hal_pin_bit_new("k.l", HAL_IN, &d->y, id));
  return 0;
}
