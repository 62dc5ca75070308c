//! Assets that one split has alone: objects in sizes that the worlds of every other split never show.

use d3dgen_model::domain::Domain;
use d3dgen_plugins::Registry;

use crate::digest::sha256;

/// Returns the domains without a share of the assets: of objects that come in several sizes, each size but the most common one
/// is left out with that chance, by the digest of its name.
pub fn without(registry: &Registry, share: f64) -> Registry {
    let mut others = registry.clone();
    let domains: Vec<Domain> = registry.iter().map(|p| p.domain().clone()).collect();
    for mut domain in domains {
        for object in &mut domain.objects {
            let (id, mut first) = (format!("{}/{}", domain.id, object.id), true);
            object.sizes_m.retain(|size| std::mem::take(&mut first) || !is_held_out(&format!("{id}/{size:?}"), share));
            let sizes = &object.sizes_m;
            object.stock.assets.retain(|a| sizes.contains(&a.size_m));
        }
        others.set_domain(domain);
    }
    others
}

fn is_held_out(asset: &str, share: f64) -> bool {
    let head = u32::from_str_radix(&sha256(asset.as_bytes())[..8], 16).expect("a digest is hexadecimal");
    f64::from(head) < share * f64::from(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_object_keeps_a_size_and_about_the_share_goes() {
        let registry = Registry::builtin();
        let sizes = |registry: &Registry| -> Vec<usize> {
            registry.iter().flat_map(|p| &p.domain().objects).map(|o| o.sizes_m.len()).collect()
        };
        let (all, rest) = (sizes(&registry), sizes(&without(&registry, 0.5)));
        assert!(rest.iter().all(|n| *n > 0));
        let spare = |sizes: &[usize]| sizes.iter().map(|n| n - 1).sum::<usize>() as f64;
        let left = spare(&rest) / spare(&all);
        assert!((0.3..0.7).contains(&left), "{left}");
    }
}
