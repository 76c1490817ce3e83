//! Configuration of tests with random inputs.

use proptest::test_runner::{Config, RngSeed};

/// `n` inputs, the same in every run; FAYING_RANDOM=k takes k times as many, others in every run.
pub fn inputs(n: u32) -> Config {
    let more = std::env::var("FAYING_RANDOM").ok().map(|k| k.parse::<u32>().expect("FAYING_RANDOM is a whole number"));
    let rng_seed = if more.is_some() { RngSeed::Random } else { RngSeed::Fixed(1) };
    Config { cases: n * more.unwrap_or(1), failure_persistence: None, rng_seed, ..Config::default() }
}
