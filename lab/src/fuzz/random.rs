//! Numbers that look random and are the same on every machine.

use glam::DVec3;

/// SplitMix64 (Steele, Lea, Flood 2014).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The numbers of a seed's `stream`; another stream is other numbers.
    pub fn of(seed: u64, stream: u64) -> Self {
        let mut mixed = Self(seed);
        let start = mixed.word();
        let mut numbers = Self(start ^ stream.wrapping_mul(0xd6e8_feb8_6659_fd93));
        numbers.word();
        numbers
    }

    /// The next 64 bits.
    pub fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// A number in `[0, 1)`.
    pub fn unit(&mut self) -> f64 {
        (self.word() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A number in `[low, high)`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A number in `[low, high)`, evenly by its logarithm; both are above 0.
    pub fn by_size(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// A whole number from `low` to `high`, both included.
    pub fn whole(&mut self, low: u32, high: u32) -> u32 {
        low + ((self.word() >> 32) % (u64::from(high.max(low) - low) + 1)) as u32
    }

    /// A whole number from `low` to `high`, evenly by its logarithm.
    pub fn count(&mut self, low: u32, high: u32) -> u32 {
        (self.by_size(f64::from(low), f64::from(high) + 1.0) as u32).clamp(low, high)
    }

    /// Whether something of this probability happens.
    pub fn chance(&mut self, share: f64) -> bool {
        self.unit() < share
    }

    /// One of several.
    pub fn pick<T: Copy, const N: usize>(&mut self, of: [T; N]) -> T {
        of[self.whole(0, N as u32 - 1) as usize]
    }

    /// A point of the cube from -1 to 1.
    pub fn vector(&mut self) -> DVec3 {
        DVec3::new(self.between(-1.0, 1.0), self.between(-1.0, 1.0), self.between(-1.0, 1.0))
    }

    /// A point of the cube from 0 to 1.
    pub fn point(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit())
    }

    /// A direction of length 1.
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let v = self.vector();
            if (1e-3..=1.0).contains(&v.length()) {
                return v.normalize();
            }
        }
    }
}
