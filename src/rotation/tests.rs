//! Tests of the closed-form rotation against exact arithmetic and the SVD.

use super::{Rotation, polar, polar_or};
use crate::simd::{LANES, Lanes};
use nalgebra::Matrix2;
use num_bigint::BigInt;

/// Returns a finite f64 as an integer times 2^−1074, exactly.
fn exact(value: f64) -> BigInt {
    let bits = value.to_bits();
    let exponent = (bits >> 52) & 0x7ff;
    let fraction = bits & ((1 << 52) - 1);
    let magnitude = match exponent {
        0 => BigInt::from(fraction),
        _ => BigInt::from(fraction | (1 << 52)) << (exponent - 1),
    };
    if value.is_sign_negative() { -magnitude } else { magnitude }
}

/// Checks the definition in exact arithmetic: RᵀF is symmetric, its trace is positive, and R is a rotation.
fn check_exactly(f: &Matrix2<f64>, r: Rotation) {
    assert!((r.c.hypot(r.s) - 1.0).abs() < 4.0 * f64::EPSILON, "not a rotation: {r:?} of {f:?}");
    let (a, b) = (exact(f.m11) + exact(f.m22), exact(f.m21) - exact(f.m12));
    let (c, s) = (exact(r.c), exact(r.s));
    let skew = &c * &b - &s * &a;
    let trace = &c * &a + &s * &b;
    assert!(trace > BigInt::ZERO, "a turn too far: {r:?} of {f:?}");
    // |skew| ≤ 4 ε · trace means that the angle is exact to four units in the last place.
    assert!((skew.magnitude() << 50u32) <= *trace.magnitude(), "wrong angle: {r:?} of {f:?}");
}

fn check(f: &Matrix2<f64>) {
    let undefined = exact(f.m11) == -exact(f.m22) && exact(f.m21) == exact(f.m12);
    match polar(f) {
        Some(r) => {
            assert!(!undefined, "a rotation of a scaled reflection: {f:?}");
            check_exactly(f, r);
        }
        None => assert!(undefined, "no rotation of {f:?}"),
    }
}

/// A fixed sequence of well-mixed 64-bit numbers (splitmix64, Steele et al. 2014).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    }

    fn any_finite(&mut self) -> f64 {
        loop {
            let value = f64::from_bits(self.bits());
            if value.is_finite() {
                return value;
            }
        }
    }
}

#[test]
fn a_million_matrices_against_exact_arithmetic() {
    let mut random = Random(1);
    for i in 0..1_000_000 {
        let [a, b, c, d] = match i % 5 {
            // Ordinary numbers.
            0 => [(); 4].map(|()| random.uniform()),
            // Any bit pattern: subnormal to the largest, with entries hundreds of decades apart.
            1 => [(); 4].map(|()| random.any_finite()),
            // Almost a scaled reflection: the sums cancel.
            2 => {
                let (p, q) = (random.uniform(), random.uniform());
                let nudge = |v: f64, random: &mut Random| f64::from_bits(v.to_bits() ^ (random.bits() & 3));
                [p, nudge(q, &mut random), q, -nudge(p, &mut random)]
            }
            // Singular, or a reflection, at some scale.
            3 => {
                let scale = 2f64.powi((random.bits() % 2000) as i32 - 1000);
                let (p, q, k) = (random.uniform() * scale, random.uniform() * scale, (random.bits() % 3) as f64 - 1.0);
                [p, q, k * p, k * q]
            }
            // Subnormal.
            _ => [(); 4].map(|()| random.uniform() * 1e-308),
        };
        check(&Matrix2::new(a, b, c, d));
    }
}

#[test]
fn adversarial_matrices_against_exact_arithmetic() {
    let special = [
        0.0,
        -0.0,
        5e-324,
        -5e-324,
        2.3e-308,
        1e-300,
        1e-16,
        0.5,
        1.0,
        -1.0,
        1.0 + f64::EPSILON,
        3.0,
        1e16,
        -1e300,
        1e300,
        f64::MAX,
        -f64::MAX,
    ];
    for a in special {
        for b in special {
            for c in special {
                for d in special {
                    check(&Matrix2::new(a, b, c, d));
                }
            }
        }
    }
}

#[test]
fn rotations_agree_with_the_svd() {
    let mut random = Random(2);
    for _ in 0..100_000 {
        let f = Matrix2::from_fn(|_, _| random.uniform());
        let svd = f.svd(true, true);
        let (u, v_t) = (svd.u.unwrap(), svd.v_t.unwrap());
        // The nearest proper rotation is U diag(1, det(U Vᵀ)) Vᵀ: the smaller singular value takes the sign.
        let sign = (u * v_t).determinant().signum();
        let nearest = u * Matrix2::new(1.0, 0.0, 0.0, sign) * v_t;
        let gap = svd.singular_values[0] + sign * svd.singular_values[1];
        let r = polar(&f).unwrap().matrix();
        assert!((r - nearest).norm() < 1e-14 / gap.max(1e-9), "{f} {r} {nearest}");
    }
}

#[test]
fn the_polar_factor_is_exact_or_undefined_for_any_four_numbers() {
    bolero::check!().with_type().with_iterations(20_000).cloned().for_each(|[a, b, c, d]: [f64; 4]| {
        let f = Matrix2::new(a, b, c, d);
        if f.iter().all(|v| v.is_finite()) {
            check(&f);
        } else {
            assert!(polar(&f).is_none());
        }
    });
}

#[test]
fn the_rotation_of_a_rotated_stretch_is_recovered() {
    let parts = (-3.1..3.1f64, -3.0..3.0f64, -3.0..3.0f64, 0.0..3.1f64);
    bolero::check!().with_generator(parts).with_iterations(20_000).cloned().for_each(|(angle, p, q, axis)| {
        let v = Rotation::from_angle(axis).matrix();
        let stretch = v * Matrix2::new(10f64.powf(p), 0.0, 0.0, 10f64.powf(q)) * v.transpose();
        let r = polar(&(Rotation::from_angle(angle).matrix() * stretch)).unwrap();
        assert!((r.angle() - angle).abs() < 1e-12);
    });
}

#[test]
fn a_mirrored_element_gets_a_rotation_not_a_reflection() {
    let parts = (-3.1..3.1f64, 0.5..2.0f64, 0.01..0.4f64);
    bolero::check!().with_generator(parts).with_iterations(20_000).cloned().for_each(|(angle, p, q)| {
        let f = Rotation::from_angle(angle).matrix() * Matrix2::new(p, 0.0, 0.0, -q);
        let r = polar(&f).unwrap();
        assert!((r.matrix().determinant() - 1.0).abs() < 1e-14);
        assert!((r.angle() - angle).abs() < 1e-12);
    });
}

#[test]
fn the_previous_rotation_is_kept_where_none_is_defined() {
    let previous = Rotation::from_angle(0.7);
    for f in [Matrix2::zeros(), Matrix2::new(2.0, 3.0, 3.0, -2.0), Matrix2::new(f64::NAN, 0.0, 0.0, 1.0)] {
        assert_eq!(polar_or(&f, previous), previous);
    }
}

/// Every SIMD lane gives the result of a single element, independent of the other lanes.
#[test]
fn elements_in_simd_lanes_have_the_rotations_of_single_ones() {
    let ordinary = [Matrix2::new(0.3, -1.0, 2.0, 0.7), Matrix2::identity(), Matrix2::new(-1.0, 0.1, 0.0, -3.0)];
    let others = [
        Matrix2::new(1.0, 0.2, -0.2, 1.0),
        Matrix2::zeros(),
        Matrix2::new(f64::NAN, 0.0, 0.0, 1.0),
        Matrix2::new(1e-300, 0.0, 2e-300, 1e-300),
        Matrix2::new(1e308, -1e308, 1e308, 1e308),
    ];
    let previous = [0.1, 0.2, 0.3, 0.4].map(Rotation::from_angle);
    for other in others {
        for place in 0..LANES {
            let mut all = [ordinary[0], ordinary[1], ordinary[2], ordinary[0]];
            all[place] = other;
            let beside = Matrix2::from_fn(|row, column| Lanes::from(all.map(|f| f[(row, column)])));
            let before = Rotation { c: previous.map(|r| r.c).into(), s: previous.map(|r| r.s).into() };
            let Rotation { c, s } = polar_or(&beside, before);
            for (lane, (f, previous)) in all.iter().zip(previous).enumerate() {
                let alone = polar_or(f, previous);
                assert_eq!((c.into_arr()[lane], s.into_arr()[lane]), (alone.c, alone.s), "{f}");
            }
        }
    }
}
