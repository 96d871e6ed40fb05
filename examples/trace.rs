use warpbeam::scene::*;
use warpbeam::simulation::*;
fn main() {
    let a: Vec<String> = std::env::args().skip(1).collect();
    let s = open(&Source { name: a[0].clone(), assignments: a[1..].to_vec() }).unwrap();
    let mut sim = Simulation::new(&s).unwrap();
    while *sim.status() == Status::Running {
        sim.step();
        let (f, n) = sim.load_stepping();
        let m = sim.displacement().iter().map(|u| u.norm()).fold(0.0, f64::max);
        println!("{:3} factor {:.4} steps {} residual {:.3e} maxu {:.3e}", sim.iterations(), f, n, sim.residual(), m);
    }
    println!("{:?} {:?}", sim.status(), sim.certificate());
}
