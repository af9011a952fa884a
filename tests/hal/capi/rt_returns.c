/* What the calls that only realtime modules have give, and say on stderr, for the right use and for each wrong one. */
#include <hal.h>
#include <rtapi_app.h>
#include <rtapi_io.h>
#include <rtapi_list.h>
#include <rtapi_string.h>

MODULE_LICENSE("GPL");

static int id, second;

#define R(e)                                                                     \
  do {                                                                           \
    int r_ = (int)(e);                                                           \
    rtapi_print_msg(RTAPI_MSG_ERR, "%-75s -> %d\n", #e, r_);                     \
  } while (0)

struct item {
  int value;
  struct rtapi_list_head list;
};

static void nothing(void* arg, long period) {
  (void)arg;
  (void)period;
}

static int make(const char* prefix, const char* arg) {
  static hal_bit_t** pin;
  pin = hal_malloc(sizeof *pin);
  rtapi_print_msg(RTAPI_MSG_ERR, "make %s '%s'\n", prefix, arg);
  return pin ? hal_pin_bit_newf(HAL_IN, pin, id, "%s.made", prefix) : -ENOMEM;
}

static void lists(void) {
  struct item items[3];
  struct rtapi_list_head head, *at;
  int i, sum = 0;
  RTAPI_INIT_LIST_HEAD(&head);
  for (i = 0; i < 3; i++) {
    items[i].value = i + 1;
    rtapi_list_add_tail(&items[i].list, &head);
  }
  rtapi_list_del(&items[1].list);
  rtapi_list_for_each(at, &head) sum = 10 * sum + rtapi_list_entry(at, struct item, list)->value;
  R(sum);
}

static void texts(void) {
  char text[8];
  int n = 0;
  char* end;
  char** words = rtapi_argv_split(RTAPI_GFP_KERNEL, " one  two three", &n);
  R(n);
  rtapi_print_msg(RTAPI_MSG_ERR, "words %s %s %s\n", words[0], words[1], words[2]);
  rtapi_argv_free(words);
  R(rtapi_strlcpy(text, "a long text", sizeof text));
  R(rtapi_strlcat(text, "more", sizeof text));
  rtapi_print_msg(RTAPI_MSG_ERR, "text '%s'\n", text);
  R(simple_strtol("0x1f rest", &end, 0));
  rtapi_print_msg(RTAPI_MSG_ERR, "end '%s'\n", end);
  R(simple_strtol("-17", NULL, 10));
}

int rtapi_app_main(void) {
  R((id = hal_init("rt_returns")) > 0);
  R(hal_init("rt_returns"));
  R((second = hal_init("rt_returns_2")) > 0);
  R(hal_create_thread("t", 1000000, 1) > 0);
  R(hal_create_thread("t", 1000000, 1));
  R(hal_create_thread("fast", 10, 1));
  R(hal_create_thread("t2", 2000000, 1) > 0);
  R(hal_export_funct("f", nothing, NULL, 1, 0, id));
  R(hal_export_funct("f", nothing, NULL, 1, 0, id));
  R(hal_export_funct("g", nothing, NULL, 1, 0, 9999));
  R(hal_export_funct("g", NULL, NULL, 1, 0, id));
  R(hal_export_functf(nothing, NULL, 1, 0, second, "g.%d", 2));
  R(hal_add_funct_to_thread("f", "t", 1));
  R(hal_add_funct_to_thread("f", "t2", 1));
  R(hal_export_funct("twice", nothing, NULL, 1, 1, id)); /* reentrant: any number of places */
  R(hal_add_funct_to_thread("twice", "t", -1));
  R(hal_add_funct_to_thread("twice", "t2", -1));
  R(hal_add_funct_to_thread("twice", "t", 1));
  R(hal_del_funct_from_thread("twice", "t"));
  R(hal_init_funct_to_thread("twice", "t", -1));
  R(hal_del_funct_from_thread("twice", "t"));
  R(hal_del_funct_from_thread("twice", "t2"));
  R(hal_init_funct_to_thread("twice", "t", -1));
  R(hal_add_funct_to_thread("twice", "t2", -1));
  R(hal_del_funct_from_thread("twice", "t"));
  R(hal_del_funct_from_thread("twice", "t"));
  R(hal_add_funct_to_thread("f", "t", 0));
  R(hal_add_funct_to_thread("f", "nope", 1));
  R(hal_add_funct_to_thread("nope", "t", 1));
  R(hal_add_funct_to_thread("g.2", "t", 5));
  R(hal_init_funct_to_thread("g.2", "t", -1));
  R(hal_del_funct_from_thread("g.2", "t2"));
  R(hal_del_funct_from_thread("g.2", "t"));
  R(hal_del_funct_from_thread("g.2", "t"));
  R(hal_thread_delete("nope"));
  R(hal_thread_delete("t2"));
  R(hal_set_constructor(id, make));
  R(hal_comp_invoke_make("rt_returns", "more.0", "x=1"));
  R(hal_comp_invoke_make("rt_returns_2", "more.1", ""));
  R(hal_comp_invoke_make("nope", "more.2", ""));
  R(rtapi_clock_set_period(0));
  R(rtapi_clock_set_period(500));
  R(rtapi_task_new(NULL, NULL, 1, id, 1000, 1));
  R(rtapi_task_self());
  R(rtapi_prio_next_lower(rtapi_prio_highest()) < rtapi_prio_highest());
  R(rtapi_prio_next_lower(rtapi_prio_lowest()) == rtapi_prio_lowest());
  R(rtapi_is_kernelspace());
  R(hal_extend_counter(0xfff0, 5, 16));
  R(hal_extend_counter(5, 0xfffe, 16));
  R(rtapi_inb(0x80));
  lists();
  texts();
  R(hal_ready(second));
  R(hal_export_funct("late", nothing, NULL, 1, 0, second));
  R(hal_exit(second));
  R(hal_exit(second));
  return hal_ready(id);
}

void rtapi_app_exit(void) {
  R(hal_malloc(8) != NULL);
  R(hal_exit(id));
}
