//! Stage `scenario`: under construction.
