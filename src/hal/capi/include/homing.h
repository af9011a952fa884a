/* What a module with homing of its own gives to the motion controller. */
#ifndef HOMING_H
#define HOMING_H

#include <rtapi_bool.h>

/* Of home_flags. */
#define HOME_IGNORE_LIMITS 1
#define HOME_USE_INDEX 2
#define HOME_IS_SHARED 4
#define HOME_UNLOCK_FIRST 8
#define HOME_ABSOLUTE_ENCODER 16
#define HOME_NO_REHOME 32
#define HOME_NO_FINAL_MOVE 64
#define HOME_INDEX_NO_ENCODER_RESET 128

/* The controller's own; a module only hands it on. */
typedef struct emcmot_joint_t emcmot_joint_t;
#ifndef MOTION_H
typedef enum {
  EMCMOT_MOTION_DISABLED = 0,
  EMCMOT_MOTION_FREE,
  EMCMOT_MOTION_TELEOP,
  EMCMOT_MOTION_COORD
} motion_state_t;
#endif

#ifdef __cplusplus
extern "C" {
#endif

extern int homing_init(int id, double servo_period, int n_joints, int n_extrajoints,
                       emcmot_joint_t* joints);
/* The controller's functions for locking rotary joints. */
extern void homeMotFunctions(void (*pSetRotaryUnlock)(int joint, int unlock),
                             int (*pGetRotaryIsUnlocked)(int joint));
extern void read_homing_in_pins(int njoints);
/* A cycle; true when all joints are homed. */
extern bool do_homing(void);
extern void write_homing_out_pins(int njoints);
/* -1: all joints. */
extern void do_home_joint(int joint);
extern void do_cancel_homing(int joint);
extern void set_unhomed(int joint, motion_state_t state);
extern void set_joint_homing_params(int joint, double offset, double home, double home_final_vel,
                                    double home_search_vel, double home_latch_vel, int home_flags,
                                    int home_sequence, bool volatile_home);
extern void update_joint_homing_params(int joint, double offset, double home, int sequence);

extern bool get_allhomed(void);
extern bool get_homing_is_active(void);
extern int get_home_sequence(int joint);
extern bool get_homing(int joint);
extern bool get_homed(int joint);
extern bool get_index_enable(int joint);
extern bool get_home_needs_unlock_first(int joint);
extern bool get_home_is_idle(int joint);
extern bool get_home_is_synchronized(int joint);
extern bool get_homing_at_index_search_wait(int joint);

#ifdef __cplusplus
}
#endif

#endif
