/* What makes a shared object a module: its two entries, its parameters, and what it says of itself.

     static int channels = 1;
     RTAPI_MP_INT(channels, "number of channels");
     MODULE_LICENSE("GPL");
     int rtapi_app_main(void) { ... }
     void rtapi_app_exit(void) { ... }
*/
#ifndef RTAPI_APP_H
#define RTAPI_APP_H

#include <rtapi.h>

#ifndef RTAPI
#error "rtapi_app.h is for realtime components: define RTAPI, not ULAPI"
#endif

RTAPI_BEGIN_DECLS

/* 0, or a negative errno: then all that the module made so far is undone. */
extern __attribute__((visibility("default"))) int rtapi_app_main(void);
extern __attribute__((visibility("default"))) void rtapi_app_exit(void);

/* One parameter as the loader sees it. */
struct rtapi_module_parameter {
  const char* name;
  const char* description;
  void* address;
  unsigned int count; /* elements of an array; 0: not an array */
  char type;          /* i int, l long, s string (char*), u unsigned int */
};

/* All parameters of a module stand in one section, and the table says where that is. */
extern const struct rtapi_module_parameter __start_rtapi_params[]
    __attribute__((weak, visibility("hidden")));
extern const struct rtapi_module_parameter __stop_rtapi_params[]
    __attribute__((weak, visibility("hidden")));
struct rtapi_module_table {
  unsigned int abi;
  const struct rtapi_module_parameter* begin;
  const struct rtapi_module_parameter* end;
};
#define RTAPI_MODULE_ABI 1
/* In every source of the module that includes this; the linker keeps one. */
__attribute__((weak, visibility("default"))) struct rtapi_module_table rtapi_module_table = {
    RTAPI_MODULE_ABI, __start_rtapi_params, __stop_rtapi_params};

RTAPI_END_DECLS

#define RTAPI_PARAM_(var, address, count, type, description)                           \
  static const struct rtapi_module_parameter rtapi_param_##var                         \
      __attribute__((used, aligned(8), section("rtapi_params"))) = {#var, description, \
                                                                    (void*)(address), count, type}
#define RTAPI_MP_INT(var, description) RTAPI_PARAM_(var, &var, 0, 'i', description);
#define RTAPI_MP_LONG(var, description) RTAPI_PARAM_(var, &var, 0, 'l', description);
#define RTAPI_MP_STRING(var, description) RTAPI_PARAM_(var, &var, 0, 's', description);
#define RTAPI_MP_ARRAY_INT(var, num, description) RTAPI_PARAM_(var, &var[0], num, 'i', description);
#define RTAPI_MP_ARRAY_LONG(var, num, description) \
  RTAPI_PARAM_(var, &var[0], num, 'l', description);
#define RTAPI_MP_ARRAY_STRING(var, num, description) \
  RTAPI_PARAM_(var, &var[0], num, 's', description);

/* "tag=text" in the section that modinfo(8) reads. */
#define RTAPI_PASTE_OF_(a, b) a##b
#define RTAPI_PASTE_(a, b) RTAPI_PASTE_OF_(a, b)
#define MODULE_INFO(tag, info)                                       \
  static const char RTAPI_PASTE_(rtapi_info_##tag##_, __COUNTER__)[] \
      __attribute__((used, aligned(1), section(".modinfo"))) = #tag "=" info
#define MODULE_LICENSE(text) MODULE_INFO(license, text)
#define MODULE_AUTHOR(text) MODULE_INFO(author, text)
#define MODULE_DESCRIPTION(text) MODULE_INFO(description, text)
#define MODULE_VERSION(text) MODULE_INFO(version, text)
#define MODULE_SUPPORTED_DEVICE(text) MODULE_INFO(supported_device, text)
#define MODULE_DEVICE_TABLE(type, table)
#define MODULE_PARM(var, type)
#define MODULE_PARM_DESC(var, description)

/* Makes a symbol of this module known to modules that are loaded later. halcompile hides all others. */
#define EXPORT_SYMBOL(symbol)               \
  static const char rtapi_export_##symbol[] \
      __attribute__((used, aligned(1), section(".rtapi_export"))) = #symbol
#define EXPORT_SYMBOL_GPL(symbol) EXPORT_SYMBOL(symbol)
#define EXPORT_FUNCTION(symbol) EXPORT_SYMBOL(symbol)

#endif
