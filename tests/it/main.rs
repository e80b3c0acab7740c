//! The service over real sockets, with a real database and an engine that does as the test tells it.

mod bench;

mod edge;
mod events;
mod life;
mod lists;
mod recovery;
mod refusals;
mod repeats;
mod tables;
mod time;
