component drivehome "Homing by drives that find their home themselves, as a template for homing of one's own";
description """
For each joint that shall home, `drivehome.home-N` is true until `drivehome.drive-homed-N` says that the drive is done. A drive that takes
longer than `drivehome.patience` servo periods is given up; its joint is not homed then.
""";
option homemod;
pin out bit home-#[16] = 0 "The drive of this joint shall home";
pin in bit drive-homed-#[16] = 0 "It has homed";
pin out s32 homings = 0 "How many joints were homed";
param rw s32 patience = 2000;
license "MIT";
author "Kerf";
;;
#include <homing.h>

static int joints;
static int homing_[16], homed_[16], sequence_[16], waited[16];

static int is_joint(int joint) { return joint >= 0 && joint < joints; }

int homing_init(int id, double servo_period, int n_joints, int n_extrajoints, emcmot_joint_t *pjoints) {
  (void)id, (void)servo_period, (void)n_extrajoints, (void)pjoints;
  joints = n_joints;
  return joints <= 16 ? 0 : -1;
}

void homeMotFunctions(void (*pSetRotaryUnlock)(int, int), int (*pGetRotaryIsUnlocked)(int)) {
  (void)pSetRotaryUnlock, (void)pGetRotaryIsUnlocked;
}

void read_homing_in_pins(int njoints) { (void)njoints; }
void write_homing_out_pins(int njoints) { (void)njoints; }

static void begin(int joint) {
  if (!is_joint(joint) || homing_[joint]) return;
  homing_[joint] = 1;
  homed_[joint] = waited[joint] = 0;
}

void do_home_joint(int joint) {
  int j;
  if (joint >= 0) begin(joint);
  else for (j = 0; j < joints; ++j) begin(j);
}

void do_cancel_homing(int joint) {
  if (is_joint(joint)) homing_[joint] = 0;
}

bool do_homing(void) {
  int j, all = 1, homed = 0;
  for (j = 0; j < joints; ++j) {
    struct __comp_state *__comp_inst = __comp_first_inst;
    home(j) = homing_[j];
    if (homing_[j] && drive_homed(j)) {
      homing_[j] = 0;
      homed_[j] = 1;
      ++homed;
    } else if (homing_[j] && ++waited[j] > patience) {
      homing_[j] = 0;
    }
    all = all && homed_[j];
    homings += homed;
    homed = 0;
  }
  return all;
}

void set_unhomed(int joint, motion_state_t state) {
  int j;
  (void)state;
  if (joint >= 0) homed_[joint] = 0;
  if (joint == -1) for (j = 0; j < joints; ++j) homed_[j] = 0;
}

void set_joint_homing_params(int joint, double offset, double home, double home_final_vel, double home_search_vel, double home_latch_vel,
                             int home_flags, int home_sequence, bool volatile_home) {
  (void)offset, (void)home, (void)home_final_vel, (void)home_search_vel, (void)home_latch_vel, (void)home_flags, (void)volatile_home;
  if (is_joint(joint)) sequence_[joint] = home_sequence;
}
void update_joint_homing_params(int joint, double offset, double home, int sequence) {
  (void)offset, (void)home;
  if (is_joint(joint)) sequence_[joint] = sequence;
}

bool get_allhomed(void) {
  int j;
  for (j = 0; j < joints; ++j)
    if (!homed_[j]) return 0;
  return 1;
}
bool get_homing_is_active(void) {
  int j;
  for (j = 0; j < joints; ++j)
    if (homing_[j]) return 1;
  return 0;
}
int get_home_sequence(int joint) { return is_joint(joint) ? sequence_[joint] : 0; }
bool get_homing(int joint) { return is_joint(joint) && homing_[joint]; }
bool get_homed(int joint) { return is_joint(joint) && homed_[joint]; }
bool get_index_enable(int joint) { (void)joint; return 0; }
bool get_home_needs_unlock_first(int joint) { (void)joint; return 0; }
bool get_home_is_idle(int joint) { return !get_homing(joint); }
bool get_home_is_synchronized(int joint) { (void)joint; return 0; }
bool get_homing_at_index_search_wait(int joint) { (void)joint; return 0; }

EXPORT_SYMBOL(homing_init);
EXPORT_SYMBOL(homeMotFunctions);
EXPORT_SYMBOL(read_homing_in_pins);
EXPORT_SYMBOL(write_homing_out_pins);
EXPORT_SYMBOL(do_homing);
EXPORT_SYMBOL(do_home_joint);
EXPORT_SYMBOL(do_cancel_homing);
EXPORT_SYMBOL(set_unhomed);
EXPORT_SYMBOL(set_joint_homing_params);
EXPORT_SYMBOL(update_joint_homing_params);
EXPORT_SYMBOL(get_allhomed);
EXPORT_SYMBOL(get_homing_is_active);
EXPORT_SYMBOL(get_home_sequence);
EXPORT_SYMBOL(get_homing);
EXPORT_SYMBOL(get_homed);
EXPORT_SYMBOL(get_index_enable);
EXPORT_SYMBOL(get_home_needs_unlock_first);
EXPORT_SYMBOL(get_home_is_idle);
EXPORT_SYMBOL(get_home_is_synchronized);
EXPORT_SYMBOL(get_homing_at_index_search_wait);
