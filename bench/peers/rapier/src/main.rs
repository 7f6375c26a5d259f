//! Steps a contact scene that contact_peers wrote, by the finite elements of rapier, and writes its motion.
use cpu_time::ProcessTime;
use rapier3d::prelude::*;
use std::fmt::Write;
use std::str::{FromStr, SplitWhitespace};

const FRAME_STEPS: usize = 15;

fn next<T: FromStr>(words: &mut SplitWhitespace) -> T
where
    T::Err: std::fmt::Debug,
{
    words.next().expect("the scene ends early").parse().expect("a number")
}

fn vector(words: &mut SplitWhitespace) -> Vector {
    let (x, y, z) = (next(words), next(words), next(words));
    Vector::new(x, y, z)
}

/// SCENE MOTION awake|sleep matched|defaults
fn main() {
    let args: Vec<String> = std::env::args().collect();
    if args.len() != 5 {
        eprintln!("Usage: rapier-peer SCENE MOTION awake|sleep matched|defaults");
        std::process::exit(2);
    }
    let (sleeps, matched) = (args[3] == "sleep", args[4] == "matched");
    let text = std::fs::read_to_string(&args[1]).expect("the scene");
    let mut words = text.split_whitespace();
    let w = &mut words;
    let steps: usize = next(w);
    let h: Real = next(w);
    let (young, poisson, density, friction): (Real, Real, Real, Real) = (next(w), next(w), next(w), next(w));

    let mut world = PhysicsWorld::new();
    world.gravity = vector(w);
    world.integration_parameters.dt = h;
    if matched {
        // One implicit solve a step that ends by its residual, as corotet's does.
        world.integration_parameters.num_solver_iterations = 1;
        world.integration_parameters.soft_bodies.max_extra_substeps = 0;
        world.integration_parameters.soft_bodies.fem.linear_tolerance = 1.0e-3;
        world.integration_parameters.soft_bodies.fem.max_linear_iterations = 1000;
    }

    for _ in 0..next::<usize>(w) {
        let normal = vector(w);
        let offset: Real = next(w);
        world.colliders.insert(
            ColliderBuilder::new(SharedShape::halfspace(normal))
                .translation(normal * offset)
                .friction(friction),
        );
    }

    let (vertices, tets): (usize, usize) = (next(w), next(w));
    let rest: Vec<Vector> = (0..vertices).map(|_| vector(w)).collect();
    let cells: Vec<[u32; 4]> = (0..tets).map(|_| [next(w), next(w), next(w), next(w)]).collect();
    let mut masses = vec![0.0 as Real; vertices];
    for cell in &cells {
        let [a, b, c, d] = cell.map(|v| rest[v as usize]);
        for v in cell {
            masses[*v as usize] += density * (b - a).cross(c - a).dot(d - a) / 24.0;
        }
    }
    let material = SoftBodyMaterial {
        young_modulus: young,
        poisson_ratio: poisson,
        elastic_damping_ratio: if matched { 0.0 } else { SoftBodyMaterial::default().elastic_damping_ratio },
        ..Default::default()
    };
    let mut handles = vec![];
    for _ in 0..next::<usize>(w) {
        let mut body = SoftBodyBuilder::new((0..vertices).map(|_| vector(w)).collect())
            .masses(masses.clone())
            .cells(cells.clone())
            .material(material)
            .cell_model(SoftBodyCellModel::Corotational)
            .solver(SoftBodySolver::Fem)
            .surface_collider(ColliderBuilder::ball(0.05).density(0.0).friction(friction))
            .can_sleep(sleeps);
        if matched {
            body = body.particle_radius(0.001);
        }
        handles.push(world.insert_soft_body(body));
    }

    let (mut times, mut frames, mut kept) = (String::new(), String::new(), 0);
    for step in 1..=steps {
        let start = ProcessTime::now();
        world.step();
        writeln!(times, "{}", start.elapsed().as_secs_f64() * 1e3).unwrap();
        if step % FRAME_STEPS != 0 {
            continue;
        }
        kept += 1;
        writeln!(frames, "{step}").unwrap();
        for handle in &handles {
            let body = &world.soft_bodies[*handle];
            for (x, v) in body.particle_positions().zip(body.particle_velocities()) {
                writeln!(frames, "{} {} {} {} {} {}", x.x, x.y, x.z, v.x, v.y, v.z).unwrap();
            }
        }
    }
    let asleep = handles.iter().filter(|handle| world.soft_bodies[**handle].is_sleeping()).count();
    std::fs::write(&args[2], format!("{steps} {asleep} {kept}\n{times}{frames}")).expect("the motion");
}
