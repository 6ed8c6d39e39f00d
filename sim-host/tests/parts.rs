//! Studies in parts: the same bytes as in one piece, and nothing that does not belong together.

use crate::program::sim_host;
use crc::{CRC_64_XZ, Crc};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use sim_host::campaign::{Campaign, Robots, RunOutcome};
use sim_host::part::{MergeError, Parts, Shard, Study, write};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use yaml_rust2::{Yaml, YamlLoader};

/// Small ones of each kind. `tune` is slow: four sets, two of them the look of every part.
const STUDIES: [(&[&str], &[usize]); 4] = [
    (
        &[
            "faults", "--runs", "12", "--seed", "8841", "--only", "ice", "--only", "host",
        ],
        &[1, 3, 4, 13],
    ),
    (
        &["verify", "hobby-1kg", "--seeds", "1", "--seed", "7002"],
        &[4],
    ),
    (&["robustness", "--only", "noise", "--seeds", "3"], &[5]),
    (
        &[
            "tune",
            "hobby-1kg",
            "--evaluations",
            "4",
            "--starts",
            "2",
            "--seed",
            "3",
        ],
        &[2],
    ),
];

/// What comes of a line that is typed behind the program's name.
pub(super) fn typed(directory: &Path, line: &str) -> Output {
    let program = env!("CARGO_BIN_EXE_sim-host");
    let mut shell = Command::new("sh");
    shell.args(["-euc", &format!("\"$0\" {line}"), program]);
    shell.current_dir(directory).output().expect("a shell")
}

/// Everything that a command leaves: exit code, both streams, all files.
#[derive(Debug, PartialEq)]
struct Left {
    code: Option<i32>,
    streams: [String; 2],
    files: BTreeMap<String, Vec<u8>>,
}

fn left(directory: &Path, output: Output) -> Left {
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    let entries = fs::read_dir(directory.join("out")).expect("results");
    let files = entries.map(|entry| {
        let path = entry.expect("an entry").path();
        let name = path
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        (name, fs::read(path).expect("a file"))
    });
    Left {
        code: output.status.code(),
        streams: [text(output.stdout), text(output.stderr)],
        files: files.collect(),
    }
}

/// The parts of a study in a directory, the last one made first.
pub(super) fn parts(directory: &Path, study: &[&str], count: usize) -> Vec<PathBuf> {
    let numbers = (1..=count).rev();
    let part = |number: usize| {
        let shard = format!("{number}/{count}");
        let file = format!("{number}.parquet");
        let output = sim_host(
            directory,
            &[study, &["--shard", &shard, "--parquet", &file]].concat(),
        );
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        directory.join(file)
    };
    numbers.map(part).collect()
}

pub(super) fn names(paths: &[PathBuf]) -> Vec<&str> {
    paths
        .iter()
        .map(|path| path.to_str().expect("UTF-8"))
        .collect()
}

/// All that merging says against these files.
fn refusal(directory: &Path, paths: &[PathBuf]) -> String {
    let output = sim_host(directory, &[&["merge"], names(paths).as_slice()].concat());
    assert_eq!(output.status.code(), Some(1));
    assert!(!directory.join("out").exists(), "nothing is written");
    String::from_utf8(output.stderr).expect("UTF-8")
}

#[test]
fn any_number_of_parts_leaves_the_same_bytes() {
    for (study, counts) in STUDIES {
        let whole = tempfile::tempdir().expect("a directory");
        let output = sim_host(
            whole.path(),
            &[study, &["--parquet", "out/all.parquet"]].concat(),
        );
        let expected = left(whole.path(), output);
        assert!(
            expected.files.len() >= 3,
            "{study:?}: {:?}",
            expected.files.keys()
        );
        for count in counts {
            let here = tempfile::tempdir().expect("a directory");
            let mut paths = parts(here.path(), study, *count);
            // Neither up nor down.
            paths.rotate_left(count / 2);
            let mut merge = vec!["merge", "--parquet", "out/all.parquet"];
            merge.extend(names(&paths));
            let merged = left(here.path(), sim_host(here.path(), &merge));
            for (name, bytes) in &expected.files {
                assert!(
                    merged.files.get(name) == Some(bytes),
                    "{study:?}, {count} parts: {name}"
                );
            }
            assert_eq!(merged.streams, expected.streams, "{study:?}, {count} parts");
            assert_eq!(merged, expected, "{study:?}, {count} parts");
        }
    }
}

/// Of a set without nearly all of its parts the first are named, and how many more.
#[test]
fn a_list_of_missing_parts_ends() {
    let here = tempfile::tempdir().expect("a directory");
    let faults = [
        "faults",
        "--runs",
        "1",
        "--shard",
        "1/40",
        "--parquet",
        "one.parquet",
    ];
    let run = sim_host(here.path(), &faults);
    assert!(run.status.success(), "{run:?}");
    let merged = sim_host(here.path(), &["merge", "one.parquet"]);
    let said = String::from_utf8_lossy(&merged.stderr).into_owned();
    assert_eq!(merged.status.code(), Some(1), "{said}");
    assert_eq!(said.matches("of 40 is missing: run ").count(), 10, "{said}");
    assert!(said.contains("and 29 more are missing"), "{said}");
}

/// What is printed is what helps: the command that is printed makes the part that is missing.
#[test]
fn a_part_that_died_is_named_and_made_again_alone() {
    let here = tempfile::tempdir().expect("a directory");
    fs::copy(
        "../bases/hobby-1kg.toml",
        here.path().join("my robot's.toml"),
    )
    .expect("a robot");
    let study = ["verify", "my robot's.toml", "--seeds", "1", "--seed", "5"];
    let paths = parts(here.path(), &study, 3);
    // The second part is cut off, as by a full disk.
    let bytes = fs::read(&paths[1]).expect("a part");
    fs::write(&paths[1], &bytes[..bytes.len() / 2]).expect("written");
    let message = refusal(here.path(), &paths);
    assert!(message.contains("2.parquet: cannot be read"), "{message}");
    let (before, command) = message.split_once(": run sim-host ").expect("a command");
    assert!(before.ends_with("part 2 of 3 is missing"), "{message}");
    let line = command.lines().next().expect("a line");
    let again = typed(here.path(), &format!("{line} --parquet 2.parquet"));
    assert!(
        again.status.success(),
        "{}",
        String::from_utf8_lossy(&again.stderr)
    );
    assert_eq!(fs::read(&paths[1]).expect("a part"), bytes);
}

#[test]
fn parts_that_do_not_belong_together_are_refused() {
    let here = tempfile::tempdir().expect("a directory");
    let faults = |more: &[&str], name: &str| {
        let path = here.path().join(name);
        let file = path.to_str().expect("UTF-8");
        let output = sim_host(
            here.path(),
            &[&["faults", "--runs", "2", "--parquet", file], more].concat(),
        );
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        path
    };
    let one = faults(&["--shard", "1/2"], "one");
    for (more, message) in [
        (
            &["--shard", "2/2", "--seed", "2"][..],
            "seed is 2 there, 1 here",
        ),
        (
            &["--shard", "2/2", "--gyro"],
            "gyro is true there, false here",
        ),
        (
            &["--shard", "2/2", "--only", "ice"],
            "only is [\"ice\"] there, [] here",
        ),
        (
            &["--shard", "2/3"],
            "the number of parts is 3 there, 2 here",
        ),
    ] {
        let other = faults(more, "other");
        let refused = refusal(here.path(), &[one.clone(), other]);
        assert!(refused.contains(message), "{refused}");
    }
    let verify = |robot: &str, name: &str| {
        let path = here.path().join(name);
        let file = path.to_str().expect("UTF-8");
        let study = [
            "verify",
            robot,
            "--seeds",
            "1",
            "--shard",
            "1/18",
            "--parquet",
            file,
        ];
        assert!(sim_host(here.path(), &study).status.success());
        path
    };
    let text = fs::read_to_string("../bases/hobby-1kg.toml").expect("a robot");
    fs::write(here.path().join("robot.toml"), format!("{text}\n# mine\n")).expect("written");
    let first = verify("robot.toml", "first");
    fs::write(here.path().join("robot.toml"), text).expect("written");
    let second = verify("robot.toml", "second");
    let refused = refusal(here.path(), &[first.clone(), second]);
    assert!(
        refused.contains("robot.text is a text with the checksum"),
        "{refused}"
    );
    let refused = refusal(here.path(), &[one, first]);
    assert!(
        refused.contains("the command is verify there, faults here"),
        "{refused}"
    );
    let foreign = here.path().join("robot.toml");
    assert!(refusal(here.path(), &[foreign]).contains("no part can be read"));
}

#[test]
fn what_only_a_whole_can_have_is_refused_of_a_part() {
    let here = tempfile::tempdir().expect("a directory");
    for arguments in [
        &["faults", "--fresh", "--shard", "1/2"][..],
        &["faults", "--run", "3", "--runs", "1", "--shard", "1/2"],
        &["verify", "hobby-1kg", "--fresh", "--shard", "1/2"],
    ] {
        let output = sim_host(here.path(), arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(message.contains("is not for a part"), "{message}");
        assert_eq!(output.status.code(), Some(1));
    }
    let output = sim_host(here.path(), &["faults", "--shard", "3/2"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("i from 1 to n"));
}

/// Two runs of the campaign and their part, one of three.
fn small() -> (Campaign, Shard, Vec<RunOutcome>) {
    let campaign = Campaign {
        on: Robots::BuiltIn,
        runs: 6,
        seed: 12,
        only: Vec::new(),
        first: 100,
    };
    let shard = Shard::new(2, 3).expect("a part");
    let runs = campaign.runs(shard.places(6), &|| {}).expect("valid");
    (campaign, shard, runs)
}

#[test]
fn the_same_part_twice_counts_once_and_two_that_differ_are_refused() {
    let here = tempfile::tempdir().expect("a directory");
    let (campaign, shard, mut runs) = small();
    let path = |name: &str| here.path().join(name);
    for (number, name) in [(1, "1"), (3, "3")] {
        let shard = Shard::new(number, 3).expect("a part");
        let runs = campaign.runs(shard.places(6), &|| {}).expect("valid");
        write(&path(name), &campaign, shard, &runs).expect("written");
    }
    write(&path("2"), &campaign, shard, &runs).expect("written");
    write(&path("2 again"), &campaign, shard, &runs).expect("written");
    let merge = |names: &[&str]| {
        let paths: Vec<_> = names.iter().map(|name| path(name)).collect();
        Parts::read(&paths).and_then(Parts::merge::<Campaign>)
    };
    let (study, whole) = merge(&["3", "2", "1", "2 again"]).expect("whole");
    assert_eq!(study, campaign);
    assert_eq!(whole, campaign.runs(0..6, &|| {}).expect("valid"));
    // The least that can differ: a bit of a number that no column has.
    runs[0].again = !runs[0].again;
    write(&path("2 again"), &campaign, shard, &runs).expect("written");
    let refused = merge(&["3", "2", "1", "2 again"]);
    assert!(
        matches!(refused, Err(MergeError::Twice { .. })),
        "{refused:?}"
    );
}

/// A bit anywhere in a file that is not as it was written: refused, or without effect; never other runs.
#[test]
fn a_flipped_bit_never_becomes_another_result() {
    let here = tempfile::tempdir().expect("a directory");
    let (campaign, _, runs) = small();
    let one = Campaign {
        runs: 2,
        first: 102,
        ..campaign
    };
    let path = here.path().join("part");
    write(&path, &one, Shard::WHOLE, &runs).expect("written");
    let bytes = fs::read(&path).expect("a part");
    let mut refused = 0;
    for place in 0..bytes.len() {
        let mut bent = bytes.clone();
        bent[place] ^= 1 << (place % 8);
        fs::write(&path, &bent).expect("written");
        let merged = Parts::read(std::slice::from_ref(&path)).and_then(Parts::merge::<Campaign>);
        match merged {
            Ok((study, read)) => assert!(study == one && read == runs, "byte {place}"),
            Err(_) => refused += 1,
        }
    }
    assert!(
        refused > bytes.len() / 4,
        "{refused} of {} bytes matter",
        bytes.len()
    );
}

/// For other programs: the columns of the Parquet file are those of the CSV file.
#[test]
fn parquet_columns_are_those_of_the_csv_file() {
    let here = tempfile::tempdir().expect("a directory");
    let output = sim_host(
        here.path(),
        &["faults", "--runs", "40", "--seed", "9", "--parquet", "runs"],
    );
    assert!(output.status.code().is_some_and(|code| code < 2));
    let mut table = csv::Reader::from_path(here.path().join("out/faults.csv")).expect("CSV");
    let header = table.headers().expect("a header").clone();
    let file = fs::File::open(here.path().join("runs")).expect("a file");
    let file = SerializedFileReader::new(file).expect("Parquet");
    assert_eq!(file.metadata().file_metadata().num_rows(), 40);
    let rows = file.get_row_iter(None).expect("rows").zip(table.records());
    let mut compared = 0;
    for (row, record) in rows {
        let (row, record) = (row.expect("a row"), record.expect("a record"));
        let fields = row.get_column_iter().zip(header.iter().zip(record.iter()));
        for ((name, field), (title, text)) in fields {
            assert_eq!(name, title);
            let same = match field {
                Field::Null => text.is_empty(),
                Field::Double(number) => text.parse() == Ok(*number),
                Field::ULong(number) => text.parse() == Ok(*number),
                Field::Str(word) => text == word,
                other => panic!("{name}: {other:?}"),
            };
            assert!(same, "{name}: {field:?}, {text}");
            compared += 1;
        }
    }
    assert_eq!(compared, 40 * header.len());
}

/// The folder of the program under test, before those of the system.
fn path_with_program() -> String {
    let program = Path::new(env!("CARGO_BIN_EXE_sim-host"));
    let folder = program.parent().expect("a folder").display();
    format!("{folder}:{}", std::env::var("PATH").unwrap_or_default())
}

fn as_whole(here: &Path, study: &[&str]) {
    let merged = Command::new("sh")
        .args(["-euc", "exec sim-host merge parts/*.parquet"])
        .env("PATH", path_with_program())
        .current_dir(here)
        .output()
        .expect("a shell");
    let whole = tempfile::tempdir().expect("a directory");
    let output = sim_host(whole.path(), study);
    assert_eq!(left(here, merged), left(whole.path(), output));
}

/// The jobs of a scheduler are run as it runs them, one by one: the body of the file with the variables that it sets.
#[test]
fn the_slurm_array_does_the_whole_study() {
    let jobs = fs::canonicalize("../cluster").expect("job files");
    let here = tempfile::tempdir().expect("a directory");
    let study = ["faults", "--runs", "8", "--seed", "77"];
    let task = |number: &str, most: &str| {
        Command::new("sh")
            .arg(jobs.join("slurm-array.sh"))
            .args(study)
            .env("PATH", path_with_program())
            .envs([
                ("PARTS", "4"),
                ("SLURM_ARRAY_TASK_ID", number),
                ("SLURM_ARRAY_TASK_MAX", most),
            ])
            .env("SLURM_CPUS_PER_TASK", "1")
            .current_dir(here.path())
            .output()
            .expect("a shell")
    };
    for number in ["3", "1", "4", "2"] {
        let output = task(number, "4");
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
    // Someone asked for more tasks than parts.
    let output = task("1", "8");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("set PARTS"));
    // The job that puts them together prints the same, and writes where the others are not.
    let merged = Command::new("sh")
        .arg(jobs.join("slurm-merge.sh"))
        .env("PATH", path_with_program())
        .env("RESULTS", "out")
        .current_dir(here.path())
        .output()
        .expect("a shell");
    let whole = tempfile::tempdir().expect("a directory");
    let output = sim_host(whole.path(), &study);
    assert_eq!(left(here.path(), merged), left(whole.path(), output));
    let text = fs::read_to_string(jobs.join("slurm-array.sh")).expect("text");
    assert!(text.contains("#SBATCH --array=1-8\n") && text.contains("${PARTS:-8}"));
}

#[test]
fn the_kubernetes_job_does_the_whole_study() {
    let text = fs::read_to_string("../cluster/kubernetes.yaml").expect("a job");
    let documents = YamlLoader::load_from_str(&text).expect("YAML");
    let job = &documents[0];
    assert_eq!(job["apiVersion"].as_str(), Some("batch/v1"));
    assert_eq!(job["kind"].as_str(), Some("Job"));
    let spec = &job["spec"];
    assert_eq!(spec["completionMode"].as_str(), Some("Indexed"));
    let container = &spec["template"]["spec"]["containers"][0];
    let of = |name: &str| {
        let all = container["env"].as_vec().expect("variables");
        let one = all
            .iter()
            .find(|entry| entry["name"].as_str() == Some(name));
        one.and_then(|entry| entry["value"].as_str())
            .expect("a value")
    };
    // The number of parts stands twice.
    let completions = spec["completions"].as_i64().expect("a number");
    assert_eq!(of("PARTS"), completions.to_string());
    assert!(of("STUDY").starts_with("faults --runs "));
    let words = |yaml: &Yaml| -> Vec<String> {
        let all = yaml.as_vec().expect("a list").iter();
        all.map(|word| word.as_str().expect("a word").to_owned())
            .collect()
    };
    let line = [words(&container["command"]), words(&container["args"])].concat();
    let here = tempfile::tempdir().expect("a directory");
    for index in ["2", "0", "3", "1"] {
        let output = Command::new(&line[0])
            .args(&line[1..])
            .env("PATH", path_with_program())
            .envs([
                ("STUDY", "faults --runs 8 --seed 77"),
                ("PARTS", "4"),
                ("OUT", "parts"),
            ])
            .env("JOB_COMPLETION_INDEX", index)
            .current_dir(here.path())
            .output()
            .expect("a shell");
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
    as_whole(here.path(), &["faults", "--runs", "8", "--seed", "77"]);
}

/// The part as a program of another version writes it: its header, with its checksum.
fn by_another_version(path: &Path) {
    let file = SerializedFileReader::new(fs::File::open(path).expect("a part")).expect("Parquet");
    let about = file.metadata().file_metadata().key_value_metadata();
    let entries = about.expect("a header").iter();
    let values: BTreeMap<_, _> = entries
        .map(|entry| (entry.key.as_str(), entry.value.clone().expect("a value")))
        .collect();
    let header = &values["two-wheeled-base.part"];
    let version = concat!("\"version\":\"", env!("CARGO_PKG_VERSION"), "\"");
    let length = env!("CARGO_PKG_VERSION").len();
    let other = header.replace(version, &format!("\"version\":\"{}\"", "9".repeat(length)));
    assert_ne!(header, &other);
    let check = Crc::<u64>::new(&CRC_64_XZ).checksum(other.as_bytes());
    let mut bytes = fs::read(path).expect("a part");
    for (from, to) in [
        (header, other),
        (
            &values["two-wheeled-base.part.check"],
            format!("{check:016x}"),
        ),
    ] {
        let at = bytes
            .windows(from.len())
            .position(|window| window == from.as_bytes())
            .expect("in the file");
        bytes[at..at + from.len()].copy_from_slice(to.as_bytes());
    }
    fs::write(path, bytes).expect("written");
}

#[test]
fn parts_of_another_version_are_refused_by_name_before_their_settings_are_looked_at() {
    let here = tempfile::tempdir().expect("a directory");
    let (campaign, shard, runs) = small();
    let path = |name: &str| here.path().join(name);
    write(&path("ours"), &campaign, shard, &runs).expect("written");
    let other = Campaign {
        seed: campaign.seed + 1,
        ..campaign
    };
    write(&path("theirs"), &other, shard, &runs).expect("written");
    by_another_version(&path("theirs"));
    let refusal = |names: &[&str]| {
        let paths: Vec<_> = names.iter().map(|name| path(name)).collect();
        let merged = Parts::read(&paths).and_then(Parts::merge::<Campaign>);
        merged.expect_err("another version").to_string()
    };
    let (theirs, ours) = (
        path("theirs").display().to_string(),
        env!("CARGO_PKG_VERSION"),
    );
    let version = "9".repeat(ours.len());
    assert_eq!(
        refusal(&["ours", "theirs"]),
        format!(
            "{theirs} does not belong to {}: the version is {version} there, {ours} here",
            path("ours").display()
        )
    );
    assert_eq!(
        refusal(&["theirs"]),
        format!(
            "{theirs}: made by another program: the version is {version} there, {ours} here; merge with the program that made the parts"
        )
    );
}
