//! The asset database: reads 3D models from the files of other programs, annotates them, keeps them, and finds them by
//! what they are for.
