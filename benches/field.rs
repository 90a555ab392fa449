//! The convolution field: value, and value with gradient, near the wall of a bifurcation and of a fine polyline.

use std::hint::black_box;

use anastomesh::testing::{Field, Tube};
use anastomesh::{Point3, Vec3};
use criterion::{Criterion, criterion_group, criterion_main};

fn tube(a: [f64; 3], b: [f64; 3], r: f64) -> Tube {
    Tube { a: Point3::from(a), b: Point3::from(b), ra: r, rb: r }
}

fn evaluate(c: &mut Criterion, name: &str, tubes: &[Tube]) {
    let mut field = Field::new(tubes, 0.4).expect("tubes with a radius");
    let points: Vec<Point3> = (0..1000)
        .map(|i| {
            let (t, a) = (f64::from(i) / 1000.0, f64::from(i) * 2.4);
            let at = &tubes[i as usize * tubes.len() / 1000];
            at.point(t) + Vec3::new(0.0, a.cos(), a.sin()) * at.radius(t)
        })
        .collect();
    c.bench_function(&format!("field/{name}/1000 values"), |b| {
        b.iter(|| points.iter().map(|p| field.value(black_box(p))).sum::<f64>());
    });
    c.bench_function(&format!("field/{name}/1000 gradients"), |b| {
        b.iter(|| points.iter().map(|p| field.value_and_gradient(black_box(p)).0).sum::<f64>());
    });
}

fn field(c: &mut Criterion) {
    let fork = [
        tube([-8.0, 0.4, 0.3], [0.0; 3], 1.0),
        tube([0.0; 3], [6.0, 5.0, 0.8], 0.8),
        tube([0.0; 3], [6.0, -5.0, -0.5], 0.8),
    ];
    evaluate(c, "bifurcation", &fork);
    let at = |i: i32| {
        let t = 0.1 * f64::from(i);
        [t, 0.6 * t.sin(), 0.6 * (0.7 * t).cos()]
    };
    let fine: Vec<Tube> = (0..120).map(|i| tube(at(i), at(i + 1), 1.0)).collect();
    evaluate(c, "polyline of 0.1 r", &fine);
}

criterion_group!(benches, field);
criterion_main!(benches);
