//! The README's commands are run, and their answers are those that it shows.

use std::path::Path;

use serde_json::Value;

use crate::support::{Server, assert_part_of, curl};

/// The README is one page: its words outside code.
const WORDS_MAX: usize = 700;
/// The words of a sentence.
const SENTENCE_WORDS_MAX: usize = 25;
/// Its numbers outside code: figures have a page of their own.
const NUMBERS_MAX: usize = 20;

/// The form of `--json` for a curl before 7.82, as the README gives it.
const OLDER_JSON: &str = "-H 'content-type: application/json' -d";

fn file(name: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).unwrap()
}

/// The fenced blocks of the README, with their language.
fn blocks(readme: &str) -> Vec<(String, String)> {
    let mut blocks = Vec::new();
    let mut open: Option<(String, String)> = None;
    for line in readme.lines() {
        match (line.strip_prefix("```"), &mut open) {
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (Some(language), None) => open = Some((language.to_owned(), String::new())),
            (None, Some((_, text))) => {
                text.push_str(line);
                text.push('\n');
            }
            (None, None) => {}
        }
    }
    blocks
}

#[tokio::test]
async fn the_curls_of_the_readme_get_the_answers_it_shows_in_both_forms() {
    let readme = file("README.md");
    assert!(readme.contains(OLDER_JSON), "the README serves a curl without --json");
    for json in ["--json", OLDER_JSON] {
        let server = Server::start().await;
        let mut asked = 0;
        let mut answer: Option<Value> = None;
        for (language, text) in blocks(&readme) {
            if language == "sh" && text.contains("curl ") {
                answer = Some(curl(&server, &text.replace("--json", json)).await);
                asked += 1;
            }
            if let (true, Some(answer)) = (language == "json", answer.take()) {
                assert_part_of(&serde_json::from_str(&text).unwrap(), &answer, usize::le, "");
            }
        }
        assert_eq!(asked, 3, "three curls are the newcomer's first five minutes");
    }
}

#[tokio::test]
async fn the_curls_at_the_end_of_the_demo_find_a_loop() {
    let server = Server::start().await;
    let shown = file("src/cli/your_own_data.txt");
    let mut answers = Vec::new();
    for text in shown.split("\n\n").filter(|text| text.starts_with("curl ")) {
        answers.push(curl(&server, text).await);
    }
    let [_, _, last] = answers.as_slice() else { panic!("three curls: {answers:#?}") };
    assert_eq!(last["loop"]["verdict"], "loop", "{last:#}");
}

/// Returns the README without its blocks and its inline code, and with the words of links alone.
fn prose(readme: &str) -> String {
    let mut in_block = false;
    let mut prose = String::new();
    for line in readme.lines() {
        if line.starts_with("```") {
            in_block = !in_block;
        } else if !in_block {
            prose.push_str(line);
            prose.push('\n');
        }
    }
    let code = regex::Regex::new("`[^`]*`|<[^>]*>").unwrap();
    let target = regex::Regex::new(r"\]\([^)]*\)").unwrap();
    target.replace_all(&code.replace_all(&prose, "code"), "]").into_owned()
}

#[test]
fn the_readme_is_one_page_of_short_sentences_and_few_numbers() {
    let prose = prose(&file("README.md"));
    let words = prose.split_whitespace().count();
    assert!(words <= WORDS_MAX, "README.md has {words} words outside code");
    let is_number =
        |word: &&str| word.trim_start_matches(['(', '[', '*']).starts_with(|c: char| c.is_ascii_digit());
    let numbers: Vec<&str> = prose.split_whitespace().filter(is_number).collect();
    assert!(numbers.len() <= NUMBERS_MAX, "{} numbers: {numbers:?}", numbers.len());
    let end = regex::Regex::new("[.?:] ").unwrap();
    let is_sentence = |line: &&str| !line.starts_with(['|', '#', '!']);
    for line in prose.lines().filter(is_sentence) {
        for sentence in end.split(line) {
            let words = sentence.split_whitespace().filter(|word| *word != "·").count();
            assert!(words <= SENTENCE_WORDS_MAX, "{words} words: {sentence}");
        }
    }
}
