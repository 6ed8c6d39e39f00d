//! Driving by velocity on bad floors.

mod driving_slow;

use rayon::prelude::*;
use sim_host::scenario::BASES;
use driving_slow::{ORDERS, drive};

#[test]
fn trace() {
    if std::env::var("TRACE").is_err() { return; }
    let b: usize = std::env::var("B").unwrap().parse().unwrap();
    let o: usize = std::env::var("O").unwrap().parse().unwrap();
    let s: u64 = std::env::var("S").unwrap().parse().unwrap();
    let base = BASES[b].base().expect("built in");
    println!("{:?}", drive(&base, &ORDERS[o], s, 12.0));
}

#[test]
fn study() {
    let seeds: u64 = std::env::var("SEEDS").map_or(8, |s| s.parse().unwrap());
    for base in BASES {
        let base = base.base().expect("built in");
        for order in ORDERS {
            let runs: Vec<_> = (0..seeds).into_par_iter().map(|seed| drive(&base, &order, 100 + seed, 12.0)).collect();
            let max = |f: fn(&driving_slow::Slow) -> f64| runs.iter().map(f).fold(0.0, f64::max);
            let ok = runs.iter().filter(|r| r.drives && r.rms < 0.1 && r.stood_s <= 0.1).count();
            println!(
                "{:14} {:5} {:5}: ok {ok}/{seeds} loose {:.2} rms {:.3} meas {:.3} stood {:.3} drives {}  means {:.3}..{:.3}  rms {:?}",
                base.name, order.linear, order.angular,
                max(|r| r.loose_s), max(|r| r.rms), max(|r| r.measured), max(|r| r.stood_s),
                runs.iter().filter(|r| r.drives).count(),
                runs.iter().map(|r| r.mean).fold(9.0, f64::min), max(|r| r.mean),
                runs.iter().map(|r| (r.rms * 1000.0).round() / 1000.0).collect::<Vec<_>>()
            );
        }
    }
}
