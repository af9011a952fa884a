/* Asks the loaded kinematics module of LinuxCNC, through the functions that such modules publish. Lines of `in`:
 *   S kind    P x y z a b c u v w (where the tool was)    J joints (where the joints were)    F joints    I x y z a b c u v w
 * For F and I a line with the code and the result goes to `out`. `quiet=1`: the module was asked for its type already. */
#include <emcpos.h>
#include <hal.h>
#include <kinematics.h>
#include <rtapi.h>
#include <rtapi_app.h>
#include <stdio.h>
#include <string.h>

MODULE_LICENSE("MIT");
static char* in = "";
static char* out = "";
static int quiet = 0;
RTAPI_MP_STRING(in, "questions");
RTAPI_MP_STRING(out, "answers");
RTAPI_MP_INT(quiet, "do not ask for the type");

static int id;

static void read_numbers(const char* text, double* values, int most) {
  int used = 0;
  for (int i = 0; i < most; ++i) {
    values[i] = 0;
    if (sscanf(text, "%lf%n", &values[i], &used) == 1) text += used;
  }
}

static EmcPose pose_of(const char* text) {
  double w[9];
  EmcPose p;
  memset(&p, 0, sizeof p);
  read_numbers(text, w, 9);
  p.tran.x = w[0], p.tran.y = w[1], p.tran.z = w[2];
  p.a = w[3], p.b = w[4], p.c = w[5];
  p.u = w[6], p.v = w[7], p.w = w[8];
  return p;
}

int rtapi_app_main(void) {
  char line[2000];
  double joint[16] = {0};
  KINEMATICS_FORWARD_FLAGS forward = 0;
  KINEMATICS_INVERSE_FLAGS inverse = 0;
  EmcPose world = pose_of("");
  FILE *from = fopen(in, "r"), *to = fopen(out, "w");
  id = hal_init("peer_probe");
  if (from == NULL || to == NULL) return -1;
  if (!quiet) kinematicsType();
  while (fgets(line, sizeof line, from) != NULL) {
    const char* text = line + 1;
    int code = 0;
    switch (line[0]) {
      case 'S': kinematicsSwitch(text[1] - '0'); break;
      case 'P': world = pose_of(text); break;
      case 'J': read_numbers(text, joint, 16); break;
      case 'F':
        read_numbers(text, joint, 16);
        code = kinematicsForward(joint, &world, &forward, &inverse);
        fprintf(to, "F %d %.15g %.15g %.15g %.15g %.15g %.15g %.15g %.15g %.15g\n", code,
                world.tran.x, world.tran.y, world.tran.z, world.a, world.b, world.c, world.u,
                world.v, world.w);
        break;
      case 'I': {
        EmcPose wanted = pose_of(text);
        code = kinematicsInverse(&wanted, joint, &inverse, &forward);
        fprintf(to, "I %d", code);
        for (int j = 0; j < 16; ++j) fprintf(to, " %.15g", joint[j]);
        fprintf(to, "\n");
      }
    }
  }
  fclose(from);
  fclose(to);
  hal_ready(id);
  return 0;
}

void rtapi_app_exit(void) { hal_exit(id); }
