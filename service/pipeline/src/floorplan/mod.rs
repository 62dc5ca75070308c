//! Stage `floorplan`: under construction.
