//! Stage `world`: under construction.
