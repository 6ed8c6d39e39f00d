//! Instructions of simulated ticks on the host; `tests::host_cost` says which. Without arguments it has valgrind count itself, and
//! compares with `docs/python.md`.

use std::process::ExitCode;

use tests::host_cost::{CASES, compare};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [name, parks] = arguments.as_slice() else {
        let program = std::env::current_exe().expect("a program has a path");
        compare(&program);
        return ExitCode::SUCCESS;
    };
    let case = CASES.iter().find(|case| case.name == name);
    let Some((case, parks)) = case.zip(parks.parse().ok()) else {
        eprintln!("host-cost [NAME PARKS]");
        return ExitCode::from(2);
    };
    println!("{}", case.run(parks));
    ExitCode::SUCCESS
}
