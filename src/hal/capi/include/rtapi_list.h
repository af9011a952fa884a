/* Doubly linked lists whose links stand in the elements. An empty list's head points to itself. */
#ifndef RTAPI_LIST_H
#define RTAPI_LIST_H

#include <stddef.h>

struct rtapi_list_head {
  struct rtapi_list_head *next, *prev;
};

#define RTAPI_LIST_HEAD_INIT(name) \
  { &(name), &(name) }
#define RTAPI_LIST_HEAD(name) struct rtapi_list_head name = RTAPI_LIST_HEAD_INIT(name)

static inline void RTAPI_INIT_LIST_HEAD(struct rtapi_list_head* entry) {
  entry->next = entry;
  entry->prev = entry;
}
static inline void rtapi_list_insert_(struct rtapi_list_head* entry, struct rtapi_list_head* before,
                                      struct rtapi_list_head* after) {
  entry->prev = before;
  entry->next = after;
  before->next = entry;
  after->prev = entry;
}
/* As the first one. */
static inline void rtapi_list_add(struct rtapi_list_head* new_, struct rtapi_list_head* head) {
  rtapi_list_insert_(new_, head, head->next);
}
/* As the last one. */
static inline void rtapi_list_add_tail(struct rtapi_list_head* new_, struct rtapi_list_head* head) {
  rtapi_list_insert_(new_, head->prev, head);
}
static inline void rtapi_list_del(struct rtapi_list_head* entry) {
  entry->prev->next = entry->next;
  entry->next->prev = entry->prev;
  entry->next = NULL;
  entry->prev = NULL;
}
static inline int rtapi_list_empty(const struct rtapi_list_head* head) {
  return head->next == head;
}

#define rtapi_container_of(ptr, type, member) ((type*)((char*)(ptr)-offsetof(type, member)))
#define rtapi_list_entry(ptr, type, member) rtapi_container_of(ptr, type, member)
#define rtapi_list_for_each(pos, head) for (pos = (head)->next; pos != (head); pos = pos->next)
#define rtapi_list_for_each_safe(pos, n, head) \
  for (pos = (head)->next, n = pos->next; pos != (head); pos = n, n = pos->next)
#define rtapi_list_for_each_entry(pos, head, member)                                           \
  for (pos = rtapi_list_entry((head)->next, __typeof__(*pos), member); &pos->member != (head); \
       pos = rtapi_list_entry(pos->member.next, __typeof__(*pos), member))

#endif
