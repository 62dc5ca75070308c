//! Stage `scene_graph`: under construction.
