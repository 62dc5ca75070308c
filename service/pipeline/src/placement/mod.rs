//! Stage `placement`: under construction.
