//! Bytes as all documents that they might be (`check`), guided by the code that they reach (libFuzzer); `crates/fuzz/run` builds and runs it.

#![no_main]

use libfuzzer_sys::fuzz_target;
use meshwright_fuzz_check::check;

fuzz_target!(|bytes: &[u8]| check(bytes));
