/* The common part of modules with switchkinsSetup (switchkins.h): the module's main, its pins kinstype.is-N, and the functions that the
 * motion controller calls. halcompile links it with them. */
#include <hal.h>
#include <rtapi.h>
#include <rtapi_app.h>
#include <rtapi_string.h>
#include <switchkins.h>

MODULE_LICENSE("MIT");

static char* coordinates;
RTAPI_MP_STRING(coordinates, "axis letter of each joint, joint 0 first");
static char* sparm;
RTAPI_MP_STRING(sparm, "a word for the module's setup");

enum { kinds = 16, most_joints = 16, gui_axes = 6 };

static struct kind {
  KS setup;
  KF forward;
  KI inverse;
} kind[kinds];
static int last_kind = SWITCHKINS_MAX_TYPES - 1;
static int in_force;
static kparms parms;
static int comp_id;

static EmcPose last[kinds]; /* of kinds that search from where they were */
static int has_last[kinds];

static struct pins {
  hal_bit_t* is[kinds];
  hal_float_t* gui[gui_axes];
} * pins;

static int refuse(const char* what) {
  rtapi_print_msg(RTAPI_MSG_ERR, "%s: switchkinsSetup: %s\n",
                  parms.kinsname != NULL ? parms.kinsname : "switchkins", what);
  return -1;
}

int switchkinsRegister(int ktype, KS setup, KF forward, KI inverse) {
  if (ktype < SWITCHKINS_MAX_TYPES || ktype >= kinds || setup == NULL || forward == NULL ||
      inverse == NULL)
    return -1;
  kind[ktype].setup = setup;
  kind[ktype].forward = forward;
  kind[ktype].inverse = inverse;
  if (ktype > last_kind) last_kind = ktype;
  return 0;
}

static int there(int k) { return k >= 0 && k < kinds && kind[k].forward != NULL; }

static int set_in_force(int k) {
  int n;
  if (!there(k)) return -1;
  in_force = k;
  for (n = 0; n <= last_kind; ++n) *pins->is[n] = n == k;
  return 0;
}

static int forward_of(int k, const double* joint, EmcPose* world,
                      const KINEMATICS_FORWARD_FLAGS* fflags, KINEMATICS_INVERSE_FLAGS* iflags) {
  const int searches = (parms.fwd_iterates_mask >> k & 1) != 0;
  int result;
  if (searches && has_last[k]) *world = last[k];
  result = kind[k].forward(joint, world, fflags, iflags);
  if (searches && result == 0) {
    last[k] = *world;
    has_last[k] = 1;
  }
  return result;
}

int kinematicsForward(const double* joint, struct EmcPose* world,
                      const KINEMATICS_FORWARD_FLAGS* fflags, KINEMATICS_INVERSE_FLAGS* iflags) {
  const int result = forward_of(in_force, joint, world, fflags, iflags);
  if (parms.gui_kinstype >= 0) {
    EmcPose shown = *world;
    if (parms.gui_kinstype == in_force ||
        forward_of(parms.gui_kinstype, joint, &shown, fflags, iflags) == 0) {
      *pins->gui[0] = shown.tran.x;
      *pins->gui[1] = shown.tran.y;
      *pins->gui[2] = shown.tran.z;
      *pins->gui[3] = shown.a;
      *pins->gui[4] = shown.b;
      *pins->gui[5] = shown.c;
    }
  }
  return result;
}

int kinematicsInverse(const struct EmcPose* world, double* joint,
                      const KINEMATICS_INVERSE_FLAGS* iflags, KINEMATICS_FORWARD_FLAGS* fflags) {
  return kind[in_force].inverse(world, joint, iflags, fflags);
}

KINEMATICS_TYPE kinematicsType(void) { return KINEMATICS_BOTH; }
int kinematicsSwitchable(void) { return 1; }
int kinematicsSwitch(int switchkins_type) { return set_in_force(switchkins_type); }

EXPORT_SYMBOL(kinematicsForward);
EXPORT_SYMBOL(kinematicsInverse);
EXPORT_SYMBOL(kinematicsType);
EXPORT_SYMBOL(kinematicsSwitchable);
EXPORT_SYMBOL(kinematicsSwitch);

static char upper(char c) { return c >= 'a' && c <= 'z' ? (char)(c - 'a' + 'A') : c; }

/* The letter of `wanted` that `given` leaves out; 0: none. */
static char left_out(const char* wanted, const char* given) {
  for (; *wanted != 0; ++wanted) {
    const char* at = given;
    if (upper(*wanted) < 'A' || upper(*wanted) > 'Z') continue;
    while (*at != 0 && upper(*at) != upper(*wanted)) ++at;
    if (*at == 0) return upper(*wanted);
  }
  return 0;
}

static int check(void) {
  int k;
  if (parms.kinsname == NULL || parms.kinsname[0] == 0) return refuse("it leaves kinsname out");
  if (parms.halprefix == NULL) parms.halprefix = parms.kinsname;
  if (parms.max_joints < 1 || parms.max_joints > most_joints)
    return refuse("max_joints must be between 1 and 16");
  if (parms.gui_kinstype >= 0 && !there(parms.gui_kinstype))
    return refuse("gui_kinstype is no kind of the module");
  for (k = 0; k < SWITCHKINS_MAX_TYPES; ++k)
    if (kind[k].setup == NULL || kind[k].forward == NULL || kind[k].inverse == NULL)
      return refuse("kinds 0, 1 and 2 each need setup, forward and inverse");
  if (coordinates == NULL || coordinates[0] == 0) coordinates = parms.required_coordinates;
  if (coordinates == NULL) return refuse("there is neither coordinates= nor required_coordinates");
  if (parms.required_coordinates != NULL) {
    const char letter = left_out(parms.required_coordinates, coordinates);
    if (letter != 0) {
      rtapi_print_msg(RTAPI_MSG_ERR, "%s: coordinates=%s leaves out %c; needed are %s\n",
                      parms.kinsname, coordinates, letter, parms.required_coordinates);
      return -1;
    }
  }
  return 0;
}

static int make_pins(void) {
  static const char axis[gui_axes] = {'x', 'y', 'z', 'a', 'b', 'c'};
  int n;
  pins = hal_malloc(sizeof *pins);
  if (pins == NULL) return -1;
  for (n = 0; n <= last_kind; ++n) {
    const int result = hal_pin_bit_newf(HAL_OUT, &pins->is[n], comp_id, "kinstype.is-%d", n);
    if (result != 0) return result;
  }
  for (n = 0; parms.gui_kinstype >= 0 && n < gui_axes; ++n) {
    const int result = hal_pin_float_newf(HAL_OUT, &pins->gui[n], comp_id, "skgui.%c", axis[n]);
    if (result != 0) return result;
  }
  return set_in_force(0);
}

int rtapi_app_main(void) {
  int result, k;
  parms.sparm = sparm;
  parms.gui_kinstype = -1;
  result = switchkinsSetup(&parms, &kind[0].setup, &kind[1].setup, &kind[2].setup, &kind[0].forward,
                           &kind[1].forward, &kind[2].forward, &kind[0].inverse, &kind[1].inverse,
                           &kind[2].inverse);
  if (result != 0) return refuse("it failed");
  if (check() != 0) return -1;
  comp_id = hal_init(parms.kinsname);
  if (comp_id < 0) return comp_id;
  result = make_pins();
  for (k = 0; result == 0 && k <= last_kind; ++k)
    if (kind[k].setup != NULL) result = kind[k].setup(comp_id, coordinates, &parms);
  if (result == 0) result = hal_ready(comp_id);
  if (result != 0) hal_exit(comp_id);
  return result;
}

void rtapi_app_exit(void) { hal_exit(comp_id); }
