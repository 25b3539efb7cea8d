//! `revisit vocabulary`: converts, describes and trains vocabularies.

use std::fmt::{self, Write as _};
use std::fs::{self, File};
use std::io::{self, BufRead as _, Read as _};
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, Subcommand, ValueEnum};
use serde::Deserialize;

use super::compressed_file::CompressedFile;
use super::failure::Failure;
use super::output::{progress_bar, write_out};
use crate::api::decoding::base64;
use crate::vocabulary::train::{TrainSettings, TrainingSet, train};
use crate::vocabulary::{Vocabulary, decompressed};

/// Maximum length of a line of a recording, as in `replay`.
const MAX_LINE_BYTES: u64 = 64 * 1024 * 1024;

/// zstd level of text. The file is written once, and twice the effort saves 5 %.
const ZSTD_LEVEL: i32 = 9;

/// Convert, describe and train ORB vocabularies.
///
/// A vocabulary is in DBoW2's text format (`ORBvoc.txt`; plain, gzip or zstd) or in Revisit's binary format, which
/// loads about twenty times faster. Every command accepts both, whatever the file name.
#[derive(Args, Clone, Debug)]
pub struct VocabularyArgs {
    #[command(subcommand)]
    command: Command,
}

#[derive(Clone, Debug, Subcommand)]
enum Command {
    Convert(ConvertArgs),
    Info(InfoArgs),
    Train(TrainArgs),
}

/// Convert a vocabulary to the other format.
#[derive(Args, Clone, Debug)]
struct ConvertArgs {
    /// The vocabulary, in either format
    input: PathBuf,
    /// The file to write
    output: PathBuf,
    #[command(flatten)]
    form: FormArgs,
}

/// Describe a vocabulary.
#[derive(Args, Clone, Debug)]
struct InfoArgs {
    /// The vocabulary, in either format
    file: PathBuf,
}

/// Train a vocabulary on the descriptors of recordings.
#[derive(Args, Clone, Debug)]
struct TrainArgs {
    /// NDJSON as for `replay`, plain, gzip or zstd; every keyframe with features counts as an image
    #[arg(required = true, value_name = "RECORDING")]
    recordings: Vec<PathBuf>,
    /// The file to write
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Number of clusters into which a node is split
    #[arg(long, env = "REVISIT_K", default_value_t = TrainSettings::default().branching)]
    k: u32,
    /// Number of levels; there are at most k^levels words
    #[arg(long, env = "REVISIT_LEVELS", default_value_t = TrainSettings::default().levels)]
    levels: u32,
    /// Seed of the first centres; the same seed gives the same vocabulary
    #[arg(long, env = "REVISIT_SEED", default_value_t = TrainSettings::default().seed)]
    seed: u64,
    #[command(flatten)]
    form: FormArgs,
}

#[derive(Args, Clone, Copy, Debug)]
struct FormArgs {
    /// The format to write; by default .txt, .gz and .zst are text, all other names binary
    #[arg(long, env = "REVISIT_FORM", value_enum)]
    form: Option<Form>,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum Form {
    Text,
    Binary,
}

/// Runs `vocabulary`.
pub async fn run(args: VocabularyArgs) -> Result<(), Failure> {
    // Blocking: the work waits only for disk and processor.
    tokio::task::spawn_blocking(move || match args.command {
        Command::Convert(args) => convert(&args),
        Command::Info(args) => info(&args),
        Command::Train(args) => train_on(&args),
    })
    .await?
}

fn convert(args: &ConvertArgs) -> Result<(), Failure> {
    let vocabulary = load(&args.input)?;
    save(&vocabulary, &args.output, args.form)?;
    Ok(write_out(&format!("{}\n", vocabulary.fingerprint()))?)
}

fn info(args: &InfoArgs) -> Result<(), Failure> {
    let start = Instant::now();
    let vocabulary = load(&args.file)?;
    let loaded = start.elapsed();
    let shape = vocabulary.shape();
    let mut text = String::new();
    let mut row = |name: &str, value: &dyn fmt::Display| writeln!(text, "{name:<18}{value}");
    row("k", &shape.branching)?;
    row("L", &shape.levels)?;
    row("words", &vocabulary.word_count())?;
    row("nodes", &vocabulary.node_count())?;
    row("descriptor", &format_args!("{} bytes", shape.descriptor_bytes))?;
    row("scoring", &"L1 norm, TF-IDF")?;
    row("fingerprint", &vocabulary.fingerprint())?;
    row("memory", &format_args!("{:.1} MB", vocabulary.heap_bytes() as f64 / 1e6))?;
    row("loaded in", &format_args!("{:.1} ms", loaded.as_secs_f64() * 1e3))?;
    write_out(&text)?;
    if vocabulary.fingerprint_holds() {
        return Ok(());
    }
    Err("the content does not match the fingerprint: convert the text format again".into())
}

fn train_on(args: &TrainArgs) -> Result<(), Failure> {
    let output = &args.output;
    // `train A.ndjson B.ndjson` with OUT forgotten would overwrite B.
    if output.exists() && is_recording(output)? {
        return Err(format!("{} is a recording; the file to write comes last", output.display()).into());
    }
    let mut set = TrainingSet::new();
    for recording in &args.recordings {
        read_recording(recording, &mut set).map_err(|error| format!("{}: {error}", recording.display()))?;
    }
    let progress = progress_bar("training");
    let settings =
        TrainSettings { branching: args.k, levels: args.levels, seed: args.seed, ..TrainSettings::default() };
    let trained = train(&set, settings, |at| {
        progress.set_length(at.total);
        progress.set_position(at.done);
    });
    progress.finish_and_clear();
    let vocabulary = trained?;
    save(&vocabulary, output, args.form)?;
    Ok(write_out(&format!(
        "{} words out of {} descriptors of {} images: {}\n",
        vocabulary.word_count(),
        set.descriptor_count(),
        set.image_count(),
        vocabulary.fingerprint()
    ))?)
}

fn load(path: &Path) -> Result<Vocabulary, Failure> {
    Vocabulary::load(path).map_err(|error| format!("{}: {error}", path.display()).into())
}

/// Writes a temporary file first, so that the old one stays intact until the new one is complete.
fn save(vocabulary: &Vocabulary, path: &Path, form: FormArgs) -> Result<(), Failure> {
    let partial = path.with_added_extension("partial");
    let written = write_to(vocabulary, &partial, path, form).and_then(|()| fs::rename(&partial, path));
    written.map_err(|error| {
        // It may not exist.
        let _ = fs::remove_file(&partial);
        format!("cannot write {}: {error}", path.display()).into()
    })
}

fn write_to(vocabulary: &Vocabulary, partial: &Path, path: &Path, form: FormArgs) -> io::Result<()> {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let by_name = if ["txt", "gz", "zst"].contains(&extension) { Form::Text } else { Form::Binary };
    let form = form.form.unwrap_or(by_name);
    let mut out = CompressedFile::new(File::create(partial)?, path, ZSTD_LEVEL)?;
    match form {
        Form::Text => vocabulary.write_text(&mut out)?,
        Form::Binary => vocabulary.write_binary(&mut out)?,
    }
    out.finish()?.sync_all()
}

/// The members of a recording's line that training needs.
#[derive(Deserialize)]
struct Line {
    op: String,
    body: Option<Body>,
}

#[derive(Deserialize)]
struct Body {
    features: Option<Descriptors>,
}

#[derive(Deserialize)]
struct Descriptors {
    descriptor_bytes: usize,
    descriptors: String,
}

fn read_recording(path: &Path, set: &mut TrainingSet) -> Result<(), Failure> {
    let file = File::open(path)?;
    let progress = progress_bar("reading");
    progress.set_length(file.metadata()?.len());
    let mut reader = decompressed(progress.wrap_read(file))?;
    let mut text = Vec::new();
    for number in 1_u64.. {
        text.clear();
        let length = reader.by_ref().take(MAX_LINE_BYTES).read_until(b'\n', &mut text)?;
        if length == 0 {
            break;
        }
        if length as u64 == MAX_LINE_BYTES {
            return Err(format!("line {number} is longer than {MAX_LINE_BYTES} bytes").into());
        }
        if !text.trim_ascii().is_empty() {
            add_line(&text, set).map_err(|error| format!("line {number}: {error}"))?;
        }
    }
    progress.finish_and_clear();
    Ok(())
}

fn add_line(text: &[u8], set: &mut TrainingSet) -> Result<(), Failure> {
    let line: Line = serde_json::from_slice(text)?;
    let features = line.body.and_then(|body| body.features);
    if let Some(features) = features.filter(|_| line.op == "keyframe") {
        set.add_image(features.descriptor_bytes, &base64::decode(&features.descriptors)?)?;
    }
    Ok(())
}

fn is_recording(path: &Path) -> io::Result<bool> {
    let mut head = Vec::new();
    decompressed(File::open(path)?)?.take(64).read_to_end(&mut head)?;
    Ok(head.trim_ascii_start().starts_with(b"{"))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn saved(name: &str, vocabulary: &Vocabulary, form: Option<Form>) -> Vec<u8> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        save(vocabulary, &path, FormArgs { form }).unwrap();
        assert_eq!(&load(&path).unwrap(), vocabulary, "{name}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left beside {name}");
        fs::read(path).unwrap()
    }

    #[test]
    fn keyframes_of_a_recording_train_a_vocabulary_whose_form_goes_by_the_name() {
        let line = r#"{"op":"keyframe","id":"k","body":{"stamp":{},"features":{"descriptor_bytes":8,"descriptors":"AAAAAAAAAAD//////////w"}}}"#;
        let mut set = TrainingSet::new();
        for text in [r#"{"op":"map","id":"m","body":{}}"#, line, r#"{"op":"query","keyframe":"k"}"#, line] {
            add_line(text.as_bytes(), &mut set).unwrap();
        }
        assert_eq!((set.image_count(), set.descriptor_count()), (2, 4));
        let settings = TrainSettings { branching: 2, levels: 1, ..TrainSettings::default() };
        let vocabulary = train(&set, settings, |_| {}).unwrap();

        assert!(saved("a.txt", &vocabulary, None).starts_with(b"2 1  0 0\n"));
        assert!(saved("a.txt.gz", &vocabulary, None).starts_with(&[0x1f, 0x8b]));
        assert!(saved("a.zst", &vocabulary, None).starts_with(&[0x28, 0xb5, 0x2f, 0xfd]));
        let binary = saved("a.voc", &vocabulary, None);
        assert_eq!(saved("a.txt", &vocabulary, Some(Form::Binary)), binary);
    }

    #[test]
    fn a_line_that_is_no_operation_is_refused() {
        let mut set = TrainingSet::new();
        for text in [
            "[]",
            "{",
            r#"{"op":"keyframe","body":{"features":{"descriptor_bytes":8,"descriptors":"?"}}}"#,
            r#"{"op":"keyframe","body":{"features":{"descriptor_bytes":7,"descriptors":"AAAA"}}}"#,
        ] {
            assert!(add_line(text.as_bytes(), &mut set).is_err(), "{text}");
        }
    }
}
