//! A prism condensed piece by piece, against the same prism as a whole.

use faer::Mat;
use meshwright_engine::gear::{HolePattern, Material};
use meshwright_engine::grid::{BlankGrid, GridLevel};
use meshwright_engine::run::Run;
use meshwright_engine::substructures::{AxialBasis, DividedPrism, Followers, Interface, Prism};

#[test]
fn a_ring_with_holes_in_pieces_is_the_ring_as_a_whole() {
    let pattern = HolePattern {
        count: 5,
        circle_radius: 20e-3,
        radius: 4e-3,
        phase: 0.0,
    };
    let grid = BlankGrid::new(10e-3, 30e-3, Some(&pattern), 20, 4.0, GridLevel::Coarse);
    let grid = grid.expect("a usable grid").unrolled();
    let edges: Vec<u32> = grid.hole_edges.concat();
    // So many harmonics that they are nearly dependent on the nodes of one piece.
    let weights = |nodes: &[u32]| {
        Mat::from_fn(nodes.len(), 21, |i, j| {
            let place = grid.grid.nodes[nodes[i] as usize];
            let (sin, cos) = (j.div_ceil(2) as f64 * place.y.atan2(place.x)).sin_cos();
            if j % 2 == 0 { cos } else { sin }
        })
    };
    let axial = AxialBasis::new(&[-2e-3, 3e-3], 2);
    // Even and odd motions apart and together; on a held bore, on its nodes, and on harmonics of it.
    for (twist, bore) in [(0.0, 0), (20.0, 0), (0.0, 1), (0.0, 2)] {
        let prism = Prism {
            grid: &grid.grid,
            material: &Material::STEEL,
            twist,
            axial: &axial,
        };
        let outer = grid.arc_nodes.as_slice();
        let inner = grid.bore_nodes.as_slice();
        let mut followers = vec![Followers {
            nodes: outer,
            weights: weights(outer),
        }];
        if bore == 2 {
            followers.push(Followers {
                nodes: inner,
                weights: weights(inner),
            });
        }
        let interface = Interface {
            kept: if bore == 1 { inner } else { &[] },
            followers: &followers,
            fixed: if bore == 0 { inner } else { &[] },
        };
        let nodes = grid.grid.nodes.len();
        let [whole, pieces] = [nodes, nodes / 4].map(|most| {
            let divided = DividedPrism::of_pieces(&prism, &interface, most);
            let made = divided.condense("a ring", &edges, &Run::unattended());
            made.expect("definite")
        });
        for (one, other) in [(&whole.0, &pieces.0), (&whole.1, &pieces.1)] {
            assert!(one.norm_max() > 0.0);
            // Roundings.
            let apart = (one - other).norm_max() / one.norm_max();
            assert!(apart < 1e-8, "{twist} {bore}: {apart:e}");
        }
    }
}
