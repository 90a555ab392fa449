//! Points of regions and holes on the command line.

use crate::cli::numbers::number;
use anastomesh_mesh::Point3;
use anastomesh_tet::Region;

/// Parses `X,Y,Z`.
pub fn point(text: &str) -> Result<Point3, String> {
    let values: Vec<f64> = text.split(',').map(number).collect::<Result<_, _>>()?;
    match values.as_slice() {
        &[x, y, z] if values.iter().all(|value| value.is_finite()) => Ok(Point3::new(x, y, z)),
        _ => Err("expected three finite numbers X,Y,Z".into()),
    }
}

/// Parses `X,Y,Z[:id=N][:volume=MAX]`. The id is 0 if it is not given.
pub fn region(text: &str) -> Result<Region, String> {
    let mut parts = text.split(':');
    let mut region = Region::new(point(parts.next().unwrap_or_default())?, 0);
    for part in parts {
        let (key, value) = part.split_once('=').ok_or_else(|| format!("'{part}' is not KEY=VALUE"))?;
        region = match key.trim() {
            "id" => {
                region.id = value.trim().parse().ok().filter(|id| *id > 0).ok_or("expected an id above 0")?;
                region
            }
            "volume" => region.max_volume(number(value)?),
            _ => return Err(format!("unknown key '{key}': give id or volume")),
        };
    }
    Ok(region)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regions_have_a_point_and_keys() {
        let region = region("-1,2.5,3e0:id=7:volume=0.5").expect("a region");
        assert_eq!((region.seed, region.id), (Point3::new(-1.0, 2.5, 3.0), 7));
        assert_eq!((region.max_volume, region.size), (Some(0.5), None));
        for wrong in ["1,2", "1,2,3,4", "1,2,inf", "1,2,x", "1,2,3:id=0", "1,2,3:id", "1,2,3:mass=2"] {
            assert!(super::region(wrong).is_err(), "{wrong}");
        }
    }
}
