/* A program of its own: reads arguments of the compiler, waits for its end. */
#include <math.h>
#include <signal.h>
#include <unistd.h>
#include "hal.h"

#define TEXT_(x) #x
#define TEXT(x) TEXT_(x)
static volatile sig_atomic_t done;
static void quit(int sig) { (void)sig; done = 1; }
int main(void)
{
    hal_u32_t **teeth;
    hal_float_t **root;
    int id = hal_init(TEXT(NAME));
    if (id < 0) return 1;
    teeth = hal_malloc(sizeof *teeth);
    root = hal_malloc(sizeof *root);
    if (!teeth || !root || hal_pin_u32_newf(HAL_OUT, teeth, id, "%s.teeth", TEXT(NAME)) ||
        hal_pin_float_newf(HAL_OUT, root, id, "%s.root", TEXT(NAME))) {
        hal_exit(id);
        return 1;
    }
    **teeth = TEETH;
    **root = sqrt(**teeth * 2.0);
    signal(SIGTERM, quit);
    signal(SIGINT, quit);
    hal_ready(id);
    while (!done) usleep(1000);
    hal_exit(id);
    return 0;
}
