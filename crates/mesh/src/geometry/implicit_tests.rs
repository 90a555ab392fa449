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
    on: Option<OnTriangle>,
}

impl Sample {
    fn site(&self) -> Site<'_> {
        Site { at: &self.at, on: self.on.as_ref() }
    }

    fn exact(&self) -> Vec<BigRational> {
        match &self.on {
            None => self.at.iter().map(|&x| exact(x)).collect(),
            Some(on) => {
                let ([a, b, c], [s, t]) = (&on.corners, on.weights.map(fraction));
                let at = |k: usize| exact(a[k]) + &s * (exact(b[k]) - exact(a[k])) + &t * (exact(c[k]) - exact(a[k]));
                (0..3).map(at).collect()
            }
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

fn weight() -> impl Strategy<Value = u128> {
    let any =
        prop_oneof![Just(0.5), Just(0.25), (1u32..1000).prop_map(|k| f64::from(k) / 1024.0), 0.0..1.0f64, Just(1e-3)];
    let coarse = any.prop_map(|t: f64| (t * (1u64 << 62) as f64) as u128 * (OnTriangle::ONE >> 62));
    prop_oneof![coarse, 0..=OnTriangle::ONE]
}

fn sample(scale: f64) -> impl Strategy<Value = Sample> {
    (prop::array::uniform3(point(scale)), weight(), weight(), 0..3u8).prop_map(|(corners, s, t, kind)| match kind {
        0 => Sample { at: corners[0], on: None },
        1 => implicit(OnTriangle::on_segment([corners[0], corners[1]], s)),
        _ => implicit(OnTriangle { corners, weights: [s, rest(t, s)] }),
    })
}

/// A fraction `t` of the remaining weight `1 − s`.
fn rest(t: u128, s: u128) -> u128 {
    (t >> 60) * ((OnTriangle::ONE - s) >> 60)
}

/// Exact value of a weight.
fn fraction(w: u128) -> BigRational {
    let part = |x: u128| exact((x & ((1 << 40) - 1)) as f64);
    let step = exact((1u64 << 40) as f64);
    (part(w >> 120) * &step * &step * &step + part(w >> 80) * &step * &step + part(w >> 40) * &step + part(w))
        / (&step * &step * &step)
}

fn implicit(on: OnTriangle) -> Sample {
    Sample { at: on.rounded(), on: Some(on) }
}

fn check_orient(p: &[Sample]) {
    let oracle = sign_of(&det(&rows(&p[0], &p[1..4])));
    let sites = [p[0].site(), p[1].site(), p[2].site(), p[3].site()];
    assert_eq!(orient3d(sites), oracle);
    assert_eq!(orient3d_exact(&sites), oracle);
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
        check_compare(&p[..2]);
    }

    #[test]
    fn signs_are_exact_at_the_ends_of_the_range(
        p in prop::collection::vec(sample(1e-26), 3), q in prop::collection::vec(sample(2e57), 2)
    ) {
        let all: Vec<Sample> = p.into_iter().chain(q).collect();
        let ends = |s: &Sample| s.on.map_or(vec![s.at], |on| on.corners.to_vec());
        prop_assume!(all.iter().flat_map(ends).all(|p| p.iter().all(|&x| predicates::in_exact_range(x))));
        check_orient(&all);
        check_compare(&all[2..4]);
    }

    #[test]
    fn points_of_one_segment_and_of_one_plane_are_recognised(
        a in point(1.0), b in point(1.0), c in point(1.0), d in point(1.0), t in prop::collection::vec(weight(), 4)
    ) {
        let on = |a: Point3, b: Point3, t: u128| implicit(OnTriangle::on_segment([a, b], t));
        let line = [on(a, b, t[0]), on(a, b, t[1]), on(b, a, t[2]), on(c, d, t[3]), on(c, a, t[0])];
        prop_assert_eq!(orient3d([0, 1, 2, 3].map(|i| line[i].site())), 0);
        let inside = implicit(OnTriangle { corners: [a, b, c], weights: [t[2], rest(t[3], t[2])] });
        let plane = [on(a, b, t[0]), on(b, c, t[1]), on(c, a, t[2]), inside, on(c, d, t[3])];
        prop_assert_eq!(orient3d([0, 1, 2, 3].map(|i| plane[i].site())), 0);
        check_orient(&[plane[0].clone(), plane[1].clone(), plane[2].clone(), plane[4].clone()]);
    }
}

/// True if a weight is a number rounded down.
fn is_floor(w: u128, x: &BigRational) -> bool {
    fraction(w) <= *x && fraction(w + 1) > *x
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn crossings_are_right(p in prop::collection::vec(sample(1.0), 5)) {
        let [a, b, c, u, v] = [0, 1, 2, 3, 4].map(|i| &p[i]);
        let volume = |q: [&Sample; 4]| det(&rows(q[0], &q[1..].iter().map(|s| (*s).clone()).collect::<Vec<_>>()));
        let [x, y, z] = [volume([u, v, b, c]), volume([u, v, c, a]), volume([u, v, a, b])];
        let sum = &x + &y + &z;
        let inside = [&x, &y, &z].iter().all(|w| sign_of(w) != 0 && sign_of(w) == sign_of(&sum));
        let found = crossing([a.site(), b.site(), c.site()], [u.site(), v.site()]);
        prop_assert_eq!(found.is_some(), inside);
        if let Some([s, t]) = found {
            prop_assert!(is_floor(s, &(&y / &sum)) && is_floor(t, &(&z / &sum)));
        }
        let (below, above) = (volume([a, b, c, u]), volume([a, b, c, v]));
        if sign_of(&below) * sign_of(&above) < 0 {
            let t = parameter([a.site(), b.site(), c.site()], [u.site(), v.site()]).unwrap();
            prop_assert!(is_floor(t, &(&below / (&below - &above))));
        }
    }
}
