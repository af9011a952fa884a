# spindle.tcl NAME ACCELERATION: a simulated spindle with an encoder, revolutions per second squared.
# ../mill/spindle.hal says what the pins are for.
lassign $::argv motor acceleration

loadrt sim_spindle names=$motor
addf $motor servo-thread
setp $motor.acceleration $acceleration

foreach {signal from arrow to} {
  speed-cmd    spindle.0.speed-out-rps   =>  MOTOR.velocity-cmd
  revs         MOTOR.position-fb         =>  spindle.0.revs
  speed-fb     MOTOR.velocity-fb         =>  spindle.0.speed-in
  at-speed     MOTOR.at-speed            =>  spindle.0.at-speed
  index        spindle.0.index-enable   <=>  MOTOR.index-enable
  orient       spindle.0.orient          =>  MOTOR.orient
  orient-angle spindle.0.orient-angle    =>  MOTOR.orient-angle
  is-oriented  MOTOR.is-oriented         =>  spindle.0.is-oriented
} {
  net spindle-$signal [string map [list MOTOR $motor] $from] $arrow [string map [list MOTOR $motor] $to]
}
