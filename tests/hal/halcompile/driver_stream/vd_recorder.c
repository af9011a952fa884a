/* A recorder: rows into a stream, and out of it again in the same module, with the types of the columns. */
#include "rtapi.h"
#include "rtapi_app.h"
#include "rtapi_string.h"
#include "hal.h"

MODULE_LICENSE("GPL");
static int depth = 50;
RTAPI_MP_INT(depth, "rows");
static hal_stream_t in_stream, out_stream;
static int comp_id;
typedef struct { hal_float_t *in, *mean; hal_u32_t *rows, *overruns; hal_s32_t *columns; hal_bit_t *drain; unsigned n; } rec_t;
static rec_t *rec;
static void record(void *arg, long period)
{
    hal_stream_data_u row[3];
    (void)arg; (void)period;
    row[0].f = *rec->in;
    row[1].u = rec->n++;
    row[2].b = rec->n & 1;
    if (!*rec->drain && hal_stream_write(&in_stream, row) < 0) ++*rec->overruns;
}
static void play(void *arg, long period)
{
    hal_stream_data_u row[3];
    unsigned number;
    double sum = 0;
    int n = 0;
    (void)arg; (void)period;
    if (!*rec->drain) return;
    while (hal_stream_readable(&out_stream) && hal_stream_read(&out_stream, row, &number) == 0) { sum += row[0].f; n++; }
    if (n) { *rec->mean = sum / n; *rec->rows = n; }
}
int rtapi_app_main(void)
{
    int r;
    comp_id = hal_init("vd_recorder");
    if (comp_id < 0) return comp_id;
    rec = hal_malloc(sizeof *rec);
    if (!rec) { hal_exit(comp_id); return -ENOMEM; }
    memset(rec, 0, sizeof *rec);
    r = hal_stream_create(&in_stream, comp_id, 0x56445245, depth, "fub");
    if (r < 0) { hal_exit(comp_id); return r; }
    r = hal_stream_attach(&out_stream, comp_id, 0x56445245, "fub");
    if (r >= 0) r = hal_pin_float_newf(HAL_IN, &rec->in, comp_id, "vd-recorder.in");
    if (r >= 0) r = hal_pin_float_newf(HAL_OUT, &rec->mean, comp_id, "vd-recorder.mean");
    if (r >= 0) r = hal_pin_u32_newf(HAL_OUT, &rec->rows, comp_id, "vd-recorder.rows");
    if (r >= 0) r = hal_pin_u32_newf(HAL_OUT, &rec->overruns, comp_id, "vd-recorder.overruns");
    if (r >= 0) r = hal_pin_s32_newf(HAL_OUT, &rec->columns, comp_id, "vd-recorder.columns");
    if (r >= 0) r = hal_pin_bit_newf(HAL_IN, &rec->drain, comp_id, "vd-recorder.drain");
    if (r >= 0) *rec->columns = hal_stream_element_count(&out_stream);
    if (r >= 0) r = hal_export_funct("vd-recorder.record", record, 0, 1, 0, comp_id);
    if (r >= 0) r = hal_export_funct("vd-recorder.play", play, 0, 1, 0, comp_id);
    if (r < 0) { hal_stream_detach(&out_stream); hal_stream_destroy(&in_stream); hal_exit(comp_id); return r; }
    hal_ready(comp_id);
    return 0;
}
void rtapi_app_exit(void)
{
    hal_stream_detach(&out_stream);
    hal_stream_destroy(&in_stream);
    hal_exit(comp_id);
}
