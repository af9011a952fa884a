/* A module that uses posemath.h. */
#include <hal.h>
#include <posemath.h>
#include <rtapi.h>
#include <rtapi_app.h>

MODULE_LICENSE("GPL");

static int comp;

int rtapi_app_main(void) {
  const PmRpy rpy = {0.1, 0.2, 0.3};
  const PmCartesian along_x = {1, 0, 0};
  PmPose pose = {{1, 2, 3}, {1, 0, 0, 0}}, back;
  PmCartesian there, again;
  double way;
  PmCircle circle;
  const PmCartesian start = {1, 0, 0}, end = {0, 1, 5}, centre = {0, 0, 0}, up = {0, 0, 1};
  comp = hal_init("rt_pose");
  if (comp < 0) return comp;
  pmRpyQuatConvert(&rpy, &pose.rot);
  pmPoseCartMult(&pose, &along_x, &there);
  pmPoseInv(&pose, &back);
  pmPoseCartMult(&back, &there, &again);
  pmCartCartDisp(&again, &along_x, &way);
  rtapi_print_msg(RTAPI_MSG_ERR, "there %.4f %.4f %.4f, back within %d\n", there.x, there.y, there.z, way < 1e-12);
  pmCircleInit(&circle, &start, &end, &centre, &up, 1);
  pmCirclePoint(&circle, circle.angle / 2, &there);
  rtapi_print_msg(RTAPI_MSG_ERR, "helix %.4f, half way %.4f %.4f %.4f\n", circle.angle, there.x, there.y, there.z);
  return hal_ready(comp);
}

void rtapi_app_exit(void) { hal_exit(comp); }
