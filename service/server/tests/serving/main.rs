//! A server in this process, asked by clients that do what they should not. What needs the command itself, with processes
//! that are killed, is in `tests/process`.

mod bounds;
mod changes;
mod connections;
mod library;
mod page;
mod reflection;
mod support;
mod unread;
