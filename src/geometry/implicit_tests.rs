use super::*;
use num_rational::BigRational;
use proptest::prelude::*;

fn exact(x: f64) -> BigRational {
    BigRational::from_float(x).expect("finite")
}

/// A point of either kind with its rounded coordinates.
#[derive(Clone, Debug)]
struct Sample {
    at: Point3,
    on: Option<OnSegment>,
}

impl Sample {
    fn site(&self) -> Site<'_> {
        Site { at: &self.at, on: self.on.as_ref() }
    }

    fn exact(&self) -> Vec<BigRational> {
        match &self.on {
            None => self.at.iter().map(|&x| exact(x)).collect(),
            Some(on) => (0..3).map(|k| exact(on.a[k]) + exact(on.t) * (exact(on.b[k]) - exact(on.a[k]))).collect(),
        }
    }
}

fn det(m: &[Vec<BigRational>]) -> BigRational {
    if m.len() == 1 {
        return m[0][0].clone();
    }
    let mut sum = exact(0.0);
    for (k, head) in m[0].iter().enumerate() {
        let minor: Vec<Vec<BigRational>> = m[1..]
            .iter()
            .map(|r| r.iter().enumerate().filter(|&(j, _)| j != k).map(|(_, x)| x.clone()).collect())
            .collect();
        let term = head * det(&minor);
        sum = if k % 2 == 0 { sum + term } else { sum - term };
    }
    sum
}

fn sign_of(x: &BigRational) -> i32 {
    let zero = exact(0.0);
    i32::from(*x > zero) - i32::from(*x < zero)
}

fn rows(from: &Sample, to: &[Sample]) -> Vec<Vec<BigRational>> {
    let origin = from.exact();
    to.iter().map(|p| p.exact().iter().zip(&origin).map(|(x, y)| x - y).collect()).collect()
}

fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        (-4i32..4).prop_map(f64::from),
        (-4i32..4, -3i64..3).prop_map(|(g, ulps)| f64::from(g) + ulps as f64 * f64::EPSILON * 4.0),
        (-3i32..3).prop_map(|g| f64::from(g) * 0.1),
        -1.0..1.0f64,
    ]
}

fn point(scale: f64) -> impl Strategy<Value = Point3> {
    (coordinate(), coordinate(), coordinate()).prop_map(move |(x, y, z)| Point3::new(x * scale, y * scale, z * scale))
}

fn parameter() -> impl Strategy<Value = f64> {
    prop_oneof![Just(0.5), Just(0.25), (1u32..1000).prop_map(|k| f64::from(k) / 1024.0), 0.0..1.0f64, Just(1e-3)]
}

fn sample(scale: f64) -> impl Strategy<Value = Sample> {
    (point(scale), point(scale), parameter(), any::<bool>()).prop_map(|(a, b, t, explicit)| {
        let t = (t / OnSegment::UNIT).round() * OnSegment::UNIT;
        let on = OnSegment { a, b, t };
        if explicit { Sample { at: a, on: None } } else { Sample { at: on.rounded(), on: Some(on) } }
    })
}

fn check_orient(p: &[Sample]) {
    let oracle = sign_of(&det(&rows(&p[0], &p[1..4])));
    let sites = [p[0].site(), p[1].site(), p[2].site(), p[3].site()];
    assert_eq!(orient3d(sites), oracle);
    assert_eq!(orient3d_exact(&sites), oracle);
}

fn check_insphere(p: &[Sample]) {
    let mut m = rows(&p[4], &p[..4]);
    for r in &mut m {
        let lift = r.iter().map(|x| x * x).fold(exact(0.0), |s, x| s + x);
        r.push(lift);
    }
    let oracle = -sign_of(&det(&m));
    let sites = [p[0].site(), p[1].site(), p[2].site(), p[3].site(), p[4].site()];
    assert_eq!(insphere(sites), oracle);
    assert_eq!(insphere_exact(&sites), oracle);
}

fn check_compare(p: &[Sample]) {
    // Explicit points keep the kernel's order, in which -0 comes before 0.
    let explicit = p.iter().all(|s| s.on.is_none());
    if !explicit {
        assert_eq!(compare(p[0].site(), p[1].site()), p[0].exact().cmp(&p[1].exact()));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn signs_are_exact(p in prop::collection::vec(sample(1.0), 5)) {
        check_orient(&p);
        check_insphere(&p);
        check_compare(&p[..2]);
    }

    #[test]
    fn signs_are_exact_at_the_ends_of_the_range(
        p in prop::collection::vec(sample(1e-26), 3), q in prop::collection::vec(sample(2e57), 2)
    ) {
        let all: Vec<Sample> = p.into_iter().chain(q).collect();
        let ends = |s: &Sample| s.on.map_or(vec![s.at], |on| vec![on.a, on.b]);
        prop_assume!(all.iter().flat_map(ends).all(|p| p.iter().all(|&x| predicates::in_exact_range(x))));
        check_orient(&all);
        check_insphere(&all);
        check_compare(&all[2..4]);
    }

    #[test]
    fn points_of_one_segment_and_of_one_plane_are_recognised(
        a in point(1.0), b in point(1.0), c in point(1.0), d in point(1.0), t in prop::collection::vec(parameter(), 4)
    ) {
        let on = |a: Point3, b: Point3, t: f64| {
            let on = OnSegment { a, b, t: (t / OnSegment::UNIT).round() * OnSegment::UNIT };
            Sample { at: on.rounded(), on: Some(on) }
        };
        let line = [on(a, b, t[0]), on(a, b, t[1]), on(b, a, t[2]), on(c, d, t[3]), on(c, a, t[0])];
        prop_assert_eq!(orient3d([0, 1, 2, 3].map(|i| line[i].site())), 0);
        let plane = [on(a, b, t[0]), on(b, c, t[1]), on(c, a, t[2]), on(a, c, t[3]), on(c, d, t[3])];
        prop_assert_eq!(orient3d([0, 1, 2, 3].map(|i| plane[i].site())), 0);
        check_orient(&[plane[0].clone(), plane[1].clone(), plane[2].clone(), plane[4].clone()]);
        check_insphere(&plane);
        check_insphere(&line);
    }
}

#[test]
fn ties_agree_with_the_order_of_coordinates() {
    // Eight corners of a cube, one of them the middle of a segment twice as long.
    let p = |x: f64, y: f64, z: f64| Sample { at: Point3::new(x, y, z), on: None };
    let on = OnSegment { a: Point3::new(1.0, 1.0, 0.0), b: Point3::new(1.0, 1.0, 2.0), t: 0.5 };
    let implicit = Sample { at: on.rounded(), on: Some(on) };
    let tet = [p(0., 0., 0.), p(1., 0., 0.), p(0., 1., 0.), p(0., 0., 1.)];
    for last in [implicit, p(1., 1., 1.)] {
        let sites = [tet[0].site(), tet[1].site(), tet[2].site(), tet[3].site()];
        assert_eq!(insphere([sites[0], sites[1], sites[2], sites[3], last.site()]), 0);
        assert!(!in_sphere_perturbed(sites, last.site()));
        // Seen from a tetrahedron that has the last point, another corner takes part.
        let other = [tet[1].site(), tet[2].site(), tet[3].site(), last.site()];
        let outward = orient3d(other) < 0;
        let other = if outward { [other[1], other[0], other[2], other[3]] } else { other };
        assert!(!in_sphere_perturbed(other, sites[0]) || !outward);
    }
}
