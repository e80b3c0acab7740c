//! Bytes as all that they might be (`check`), guided by what they reach in the code (libFuzzer); `crates/fuzz/run` builds and runs it.

#![no_main]

use libfuzzer_sys::fuzz_target;
use meshwright_fuzz_check::check;

fuzz_target!(|bytes: &[u8]| check(bytes));
