//! A goal's choice among several torques.

use meshwright_wire::declare::words;

words! {
    /// Choice among several torques.
    pub(crate) enum Torques {
        Largest = "largest":
            "of the torque at which it is worst: the largest value, in at_least the smallest",
        Mean = "mean": "the mean over the torques",
        Rms = "rms":
            "the root mean square over the torques; with a percent, that of each member",
    }
}
