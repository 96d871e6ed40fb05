//! Tests of affine maps of triangles, and of those of quadrilaterals and tetrahedra (article eqs. 4–24 and its examples).

use nalgebra::{Matrix2, Matrix3, Matrix4, SMatrix, SVector, Vector2, Vector3};

use super::{Affine2, AffineError, DEGENERATE};

impl Affine2 {
    /// Returns M x + d.
    fn apply(&self, x: Vector2<f64>) -> Vector2<f64> {
        self.linear * x + self.translation
    }

    /// Returns the homogeneous matrix of eq. (9), which is translation times linear part, eq. (28).
    fn homogeneous(&self) -> Matrix3<f64> {
        let (m, d) = (&self.linear, &self.translation);
        Matrix3::new(m.m11, m.m12, d.x, m.m21, m.m22, d.y, 0.0, 0.0, 1.0)
    }
}

/// Returns the matrix P of eq. (15): unknowns a₁₁ a₁₂ a₁₃ a₂₁ a₂₂ a₂₃, right-hand side x′₁ x′₂ x′₃ y′₁ y′₂ y′₃.
///
/// [`Affine2::from_triangle`] solves the same system without forming it.
fn triangle_system(rest: [Vector2<f64>; 3]) -> SMatrix<f64, 6, 6> {
    SMatrix::from_fn(|row, column| {
        let p = rest[row % 3];
        if row / 3 == column / 3 { [p.x, p.y, 1.0][column % 3] } else { 0.0 }
    })
}

/// Triangles of a quadrilateral with corners 1 2 3 4 that is cut from 1 to 3, as in eq. (21), and from 2 to 4.
const ONE_THREE: [[usize; 3]; 2] = [[0, 1, 2], [0, 2, 3]];
const TWO_FOUR: [[usize; 3]; 2] = [[0, 1, 3], [1, 2, 3]];

/// Returns the two affine maps of a quadrilateral, one for each triangle (eqs. 21–22). They depend on the diagonal
/// unless the deformation is affine.
fn quadrilateral_maps(
    [rest, deformed]: [[Vector2<f64>; 4]; 2],
    triangles: [[usize; 3]; 2],
) -> Result<[Affine2; 2], AffineError> {
    let map = |t: [usize; 3]| Affine2::from_triangle(t.map(|i| rest[i]), t.map(|i| deformed[i]));
    Ok([map(triangles[0])?, map(triangles[1])?])
}

/// Returns the homogeneous matrix (eq. 23) of the map that takes the corners `rest` of a tetrahedron to `deformed`;
/// `None` if they lie in a plane or are not finite. It solves eq. (24) with one 3×3 inverse of the edge vectors instead of
/// a 12×12 solve.
fn tetrahedron_map([rest, deformed]: [[Vector3<f64>; 4]; 2]) -> Option<Matrix4<f64>> {
    let edges = |p: &[Vector3<f64>; 4]| Matrix3::from_columns(&[p[1] - p[0], p[2] - p[0], p[3] - p[0]]);
    let (before, after) = (edges(&rest), edges(&deformed));
    let longest = before.column_iter().map(|e| e.norm()).fold(0.0, f64::max);
    let scaled = Some(before / longest).filter(|scaled| scaled.determinant().abs() > DEGENERATE)?;
    let linear = (after / longest) * scaled.try_inverse()?;
    let mut m = linear.to_homogeneous();
    m.fixed_view_mut::<3, 1>(0, 3).copy_from(&(deformed[0] - linear * rest[0]));
    m.iter().all(|v| v.is_finite()).then_some(m)
}

fn corners<const N: usize>(points: [[f64; 2]; N]) -> [Vector2<f64>; N] {
    points.map(Vector2::from)
}

const TRIANGLE: [[f64; 2]; 3] = [[0.3, -0.2], [2.1, 0.4], [0.9, 1.7]];

/// Checks that the article's system (13) and the direct map agree: P a = y.
fn assert_solves_the_system(rest: [Vector2<f64>; 3], deformed: [Vector2<f64>; 3], map: &Affine2) {
    let m = map.homogeneous();
    let a = SVector::<f64, 6>::from_row_slice(&[m[(0, 0)], m[(0, 1)], m[(0, 2)], m[(1, 0)], m[(1, 1)], m[(1, 2)]]);
    let y = SVector::<f64, 6>::from_fn(|row, _| deformed[row % 3][row / 3]);
    assert!((triangle_system(rest) * a - y).norm() < 1e-12);
}

#[test]
fn article_example_1_nothing_moves() {
    let rest = corners(TRIANGLE);
    let map = Affine2::from_triangle(rest, rest).unwrap();
    assert!((map.homogeneous() - Matrix3::identity()).norm() < 1e-14);
    assert_solves_the_system(rest, rest, &map);
}

#[test]
fn article_example_2_a_translation() {
    let rest = corners(TRIANGLE);
    let deformed = rest.map(|p| p + Vector2::new(6.0, 7.0));
    let map = Affine2::from_triangle(rest, deformed).unwrap();
    let expected = Matrix3::new(1.0, 0.0, 6.0, 0.0, 1.0, 7.0, 0.0, 0.0, 1.0);
    assert!((map.homogeneous() - expected).norm() < 1e-13);
    assert_solves_the_system(rest, deformed, &map);
}

#[test]
fn article_example_3_onto_a_line_but_not_back() {
    let (k, b) = (0.5, -1.0);
    let rest = corners(TRIANGLE);
    let deformed = rest.map(|p| Vector2::new(p.x, k * p.x + b));
    let map = Affine2::from_triangle(rest, deformed).unwrap();
    let expected = Matrix3::new(1.0, 0.0, 0.0, k, 0.0, b, 0.0, 0.0, 1.0);
    assert!((map.homogeneous() - expected).norm() < 1e-13);
    assert!(map.linear.determinant().abs() < 1e-14);
    assert_solves_the_system(rest, deformed, &map);
    assert!(matches!(Affine2::from_triangle(deformed, rest), Err(AffineError::CollinearCorners { .. })));
}

#[test]
fn collinear_corners_are_refused_at_every_size() {
    for scale in [1e-150, 1e-3, 1.0, 1e6, 1e150] {
        let rest = corners([[0.0, 0.0], [1.0, 2.0], [3.0, 6.0]]).map(|p| p * scale);
        assert!(matches!(Affine2::from_triangle(rest, rest), Err(AffineError::CollinearCorners { .. })), "{scale}");
        let rest = corners(TRIANGLE).map(|p| p * scale);
        let map = Affine2::from_triangle(rest, rest).unwrap();
        assert!((map.linear - Matrix2::identity()).norm() < 1e-13, "{scale}");
    }
    let point = corners([[1.0, 1.0]; 3]);
    assert!(matches!(Affine2::from_triangle(point, point), Err(AffineError::CollinearCorners { .. })));
    let nan = corners([[f64::NAN, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    assert_eq!(Affine2::from_triangle(nan, nan), Err(AffineError::NotFinite));
}

#[test]
fn a_quadrilateral_has_two_maps_that_depend_on_the_diagonal() {
    let rest = corners([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]);
    let deformed = corners([[0.0, 0.0], [2.0, 0.3], [2.5, 1.6], [-0.2, 1.0]]);
    let one_three = quadrilateral_maps([rest, deformed], ONE_THREE).unwrap();
    let two_four = quadrilateral_maps([rest, deformed], TWO_FOUR).unwrap();
    // Each map takes its corners to their deformed positions.
    for (map, corners) in
        [(one_three[0], [0, 1, 2]), (one_three[1], [0, 2, 3]), (two_four[0], [0, 1, 3]), (two_four[1], [1, 2, 3])]
    {
        for i in corners {
            assert!((map.apply(rest[i]) - deformed[i]).norm() < 1e-13);
        }
    }
    // All four maps differ: the quadrilateral has no single map, and the diagonal matters.
    let maps = [one_three[0], one_three[1], two_four[0], two_four[1]];
    for (i, a) in maps.iter().enumerate() {
        for b in &maps[..i] {
            assert!((a.linear - b.linear).norm() > 0.1);
        }
    }
    // The maps agree if the deformation is affine.
    let affine = rest.map(|p| Vector2::new(1.0 + 2.0 * p.x - p.y, 0.5 * p.x + 3.0 * p.y));
    let a = quadrilateral_maps([rest, affine], ONE_THREE).unwrap();
    let b = quadrilateral_maps([rest, affine], TWO_FOUR).unwrap();
    for map in [a[1], b[0], b[1]] {
        assert!((map.homogeneous() - a[0].homogeneous()).norm() < 1e-13);
    }
}

#[test]
fn a_tetrahedron_has_one_map() {
    let rest = [[0.1, 0.0, 0.2], [1.3, 0.1, 0.0], [0.2, 1.1, -0.1], [0.0, 0.3, 0.9]].map(Vector3::from);
    let m = Matrix3::new(8.442, 0.559, 2.790, 2.771, 1.936, 4.589, 0.818, 6.158, 5.564);
    let d = Vector3::new(1.0, -2.0, 3.0);
    let map = tetrahedron_map([rest, rest.map(|p| m * p + d)]).unwrap();
    assert!((map.fixed_view::<3, 3>(0, 0) - m).norm() < 1e-12 && (map.fixed_view::<3, 1>(0, 3) - d).norm() < 1e-12);
    // A general solver gives the same for all twelve rows of eq. (24).
    let p = SMatrix::<f64, 12, 12>::from_fn(|row, column| {
        let corner = rest[row % 4];
        if row / 4 == column / 4 { [corner.x, corner.y, corner.z, 1.0][column % 4] } else { 0.0 }
    });
    let y = SVector::<f64, 12>::from_fn(|row, _| (m * rest[row % 4] + d)[row / 4]);
    let a = p.lu().solve(&y).unwrap();
    for (row, entries) in a.as_slice().chunks(4).enumerate() {
        for (column, &entry) in entries.iter().enumerate() {
            assert!((map[(row, column)] - entry).abs() < 1e-11);
        }
    }
    let flat = rest.map(|p| Vector3::new(p.x, p.y, p.x + p.y));
    assert_eq!(tetrahedron_map([flat, rest]), None);
}

#[test]
fn numbers_out_of_range_are_refused() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300] {
        assert!(Affine2::from_triangle([Vector2::new(bad, 0.0); 3], [Vector2::zeros(); 3]).is_err());
        assert!(tetrahedron_map([[Vector3::repeat(bad); 4], [Vector3::zeros(); 4]]).is_none());
        assert!(quadrilateral_maps([[Vector2::repeat(bad); 4], [Vector2::zeros(); 4]], ONE_THREE).is_err());
    }
}
