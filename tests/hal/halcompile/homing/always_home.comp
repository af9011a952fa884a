component always_home "A homing module: all joints are homed at all times";
option homemod;
pin out bit is_module = 1;
license "GPL";
author "Kerf";
;;
#include "motion_types.h"
#include "homing.h"

static emcmot_joint_t *joints_;
int homing_init(int id, double servo_period, int n_joints, int n_extrajoints, emcmot_joint_t *pjoints) {
    (void)id; (void)servo_period; (void)n_joints; (void)n_extrajoints;
    joints_ = pjoints;
    return 0;
}
void homeMotFunctions(void (*pSetRotaryUnlock)(int, int), int (*pGetRotaryIsUnlocked)(int)) { (void)pSetRotaryUnlock; (void)pGetRotaryIsUnlocked; }
void read_homing_in_pins(int njoints) { (void)njoints; }
bool do_homing(void) { return 1; }
void write_homing_out_pins(int njoints) { (void)njoints; }
void do_home_joint(int jno) { (void)jno; }
void do_cancel_homing(int jno) { (void)jno; }
void set_unhomed(int jno, motion_state_t s) { (void)jno; (void)s; }
void set_joint_homing_params(int jno, double offset, double home, double home_final_vel, double home_search_vel, double home_latch_vel,
                             int home_flags, int home_sequence, bool volatile_home) {
    (void)jno; (void)offset; (void)home; (void)home_final_vel; (void)home_search_vel; (void)home_latch_vel;
    (void)home_flags; (void)home_sequence; (void)volatile_home;
}
void update_joint_homing_params(int jno, double offset, double home, int sequence) { (void)jno; (void)offset; (void)home; (void)sequence; }
bool get_allhomed(void) { return 1; }
bool get_homing_is_active(void) { return 0; }
int get_home_sequence(int jno) { (void)jno; return 0; }
bool get_homing(int jno) { (void)jno; return 0; }
bool get_homed(int jno) { (void)jno; return 1; }
bool get_index_enable(int jno) { (void)jno; return 0; }
bool get_home_needs_unlock_first(int jno) { (void)jno; return 0; }
bool get_home_is_idle(int jno) { (void)jno; return 1; }
bool get_homing_at_index_search_wait(int jno) { (void)jno; return 0; }
bool get_home_is_synchronized(int jno) { (void)jno; return 0; }

EXPORT_SYMBOL(homeMotFunctions);
EXPORT_SYMBOL(homing_init);
EXPORT_SYMBOL(do_homing);
EXPORT_SYMBOL(get_allhomed);
EXPORT_SYMBOL(get_homed);
EXPORT_SYMBOL(get_home_is_idle);
EXPORT_SYMBOL(get_home_is_synchronized);
EXPORT_SYMBOL(get_home_needs_unlock_first);
EXPORT_SYMBOL(get_home_sequence);
EXPORT_SYMBOL(get_homing);
EXPORT_SYMBOL(get_homing_at_index_search_wait);
EXPORT_SYMBOL(get_homing_is_active);
EXPORT_SYMBOL(get_index_enable);
EXPORT_SYMBOL(read_homing_in_pins);
EXPORT_SYMBOL(do_home_joint);
EXPORT_SYMBOL(do_cancel_homing);
EXPORT_SYMBOL(set_unhomed);
EXPORT_SYMBOL(set_joint_homing_params);
EXPORT_SYMBOL(update_joint_homing_params);
EXPORT_SYMBOL(write_homing_out_pins);
