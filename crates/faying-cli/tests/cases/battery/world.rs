//! Random cases: a reproducible sequence of numbers, and the frame (unit, direction, place) in which a case is written.

/// SplitMix64: the same cases on every machine.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The sequence of case `number` of a family.
    pub fn of(family: &str, number: usize) -> Self {
        let seed = family.bytes().fold(0xcbf2_9ce4_8422_2325, |h: u64, b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3));
        Self(seed ^ (number as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15))
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number of 0..n.
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() >> 11) as usize % n
    }

    /// A number of [lo, hi).
    pub fn within(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * ((self.next() >> 11) as f64 / (1u64 << 53) as f64)
    }

    /// 10 to a power of [lo, hi).
    pub fn decades(&mut self, lo: f64, hi: f64) -> f64 {
        10f64.powf(self.within(lo, hi))
    }

    pub fn chance(&mut self, share: f64) -> bool {
        self.within(0.0, 1.0) < share
    }

    pub fn pick<'a, T: ?Sized>(&mut self, from: &[&'a T]) -> &'a T {
        from[self.below(from.len())]
    }
}

/// Unit, direction and place of a case.
#[derive(Clone, Copy, Debug)]
pub struct World {
    /// Lengths are multiplied by this.
    pub length: f64,
    /// Moduli and pressures are.
    pub modulus: f64,
    /// Turned about the origin \[degrees\].
    pub angle: f64,
    /// Moved afterwards by this vector times the length.
    pub shift: [f64; 2],
}

impl World {
    /// Units of 1e-9 to 1e9, any direction, every eighth moved by up to 1e6 lengths.
    pub fn random(r: &mut Random) -> Self {
        let far = if r.chance(0.125) { r.decades(2.0, 6.0) } else { 0.0 };
        let direction = r.within(0.0, std::f64::consts::TAU);
        Self {
            length: if r.chance(0.5) { 1.0 } else { r.decades(-9.0, 9.0) },
            modulus: if r.chance(0.5) { 1.0 } else { r.decades(-9.0, 9.0) },
            angle: [0.0, 90.0, 180.0, r.within(0.0, 360.0)][r.below(4)],
            shift: [far * direction.cos(), far * direction.sin()],
        }
    }

    /// Size of the shift in lengths.
    pub fn far(&self) -> f64 {
        self.shift[0].hypot(self.shift[1])
    }

    /// A direction, turned.
    pub fn turned(&self, v: [f64; 2]) -> [f64; 2] {
        let (s, c) = self.angle.to_radians().sin_cos();
        [c * v[0] - s * v[1], s * v[0] + c * v[1]]
    }

    /// A vector of a result in the own directions, times `unit`.
    pub fn back(&self, v: [f64; 2], unit: f64) -> [f64; 2] {
        let (s, c) = self.angle.to_radians().sin_cos();
        [(c * v[0] + s * v[1]) / unit, (c * v[1] - s * v[0]) / unit]
    }

    /// "[x, y]" of a point.
    pub fn point(&self, p: [f64; 2]) -> String {
        let [x, y] = self.place(p);
        format!("[{x:.17e}, {y:.17e}]")
    }

    /// Coordinates of a point.
    pub fn place(&self, p: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.turned(p);
        [self.length * (x + self.shift[0]), self.length * (y + self.shift[1])]
    }

    /// A geometry block of a shape in its own coordinates.
    pub fn geometry(&self, shape: &str) -> String {
        let [x, y] = self.shift.map(|s| s * self.length);
        format!("{{ {shape}, scale = {:.17e}, rotate_deg = {:.17e}, move = [{x:.17e}, {y:.17e}] }}", self.length, self.angle)
    }

    /// A modulus, stress or pressure.
    pub fn stress(&self, s: f64) -> String {
        format!("{:.17e}", s * self.modulus)
    }
}
