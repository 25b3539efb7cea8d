//! Contract: what holds for every adapter, whatever it speaks to.

use std::mem::discriminant;
use std::sync::Arc;
use std::time::Duration;

use revisit::config::models::{ImageForm, ModelArgs, ResponseFormat, SystemRole, TokenParameter};
use revisit::domain::judgement::TextFunction;
use revisit::llm::adapters::{Dialect, Endpoint, Protocol, Remote, Scripted};
use revisit::llm::parse;
use revisit::llm::picture::Picture;
use revisit::llm::port::{Fault, Model, Question, Role, Round};
use serde_json::{Value, json};

use super::scene::png;
use super::stub::{Asked, Reply, Stub, level};

fn endpoint(url: &str, path: &str) -> Endpoint {
    Endpoint::new(url, path, None, Duration::from_secs(5)).unwrap()
}

fn dialect() -> Dialect {
    Dialect::from(&ModelArgs::of(&["--model-url", "http://127.0.0.1:1"]).unwrap())
}

/// A model that speaks chat completions at this base address.
fn chat_model(url: &str, name: &str, dialect: Dialect) -> Remote {
    Remote::new(endpoint(url, "chat/completions"), name, Protocol::Chat(dialect))
}

fn vqa_model(url: &str) -> Remote {
    Remote::new(endpoint(url, ""), "blip-2", Protocol::Vqa)
}

fn questions() -> Vec<Question> {
    let history = vec![Round { question: "What does it show?".to_owned(), answer: "a boat".to_owned() }];
    let (class, a, b) = ("painting".to_owned(), "a red boat".to_owned(), "a ship in a storm".to_owned());
    let picture = Arc::new(Picture::decode(&png(16, 16, [1, 2, 3])).unwrap());
    let question = "Which number?".to_owned();
    let texts = |function, b: &str| {
        let (class, a, b) = (class.clone(), a.clone(), b.to_owned());
        Question::Texts { function, class, a, b }
    };
    vec![
        texts(TextFunction::Similarity, &b),
        texts(TextFunction::Information, ""),
        texts(TextFunction::Merge, &b),
        Question::Look { picture, question, history: history.clone(), hint: Some("901".to_owned()) },
        Question::NextQuestion { class: class.clone(), history: history.clone() },
        Question::Summary { class, history },
    ]
}

/// Says something that fits.
fn sensible(asked: &Asked) -> Reply {
    match asked.what {
        "similarity" | "information" => level(3),
        "merge" => Reply::Say(json!({"text": "a red boat, a ship in a storm"}).to_string()),
        "next" => Reply::Say("Which colours?".to_owned()),
        _ => Reply::Say("a red boat".to_owned()),
    }
}

async fn adapters() -> (Stub, Stub, Vec<Arc<dyn Model>>) {
    let chat = Stub::start(sensible).await;
    let plain =
        |_: &Asked| Reply::Raw { status: 200, headers: vec![], body: json!({"answer": "901"}).to_string() };
    let vqa = Stub::start(plain).await;
    let models: Vec<Arc<dyn Model>> = vec![
        Arc::new(chat_model(&chat.url(), "stub", dialect())),
        Arc::new(vqa_model(&vqa.url())),
        Arc::new(Scripted::rehearsal()),
    ];
    (chat, vqa, models)
}

#[tokio::test]
async fn every_adapter_answers_what_it_can_and_refuses_the_rest() {
    let (_chat, _vqa, models) = adapters().await;
    for model in &models {
        for question in questions() {
            let answered = model.answer(&question).await;
            let case = format!("{model:?}: {question:?}");
            if model.can(question.role()) {
                let reply = answered.unwrap_or_else(|fault| panic!("{case}: {fault}"));
                parse::check(&question, &reply.content).unwrap_or_else(|fault| panic!("{case}: {fault}"));
            } else {
                assert_eq!(answered, Err(Fault::Unable), "{case}");
            }
        }
    }
}

#[tokio::test]
async fn every_adapter_has_an_identity_of_its_own_which_its_parameters_change() {
    let (chat, _vqa, models) = adapters().await;
    let mut identities: Vec<String> = models.iter().map(|model| model.identity()).collect();
    let changed = [
        Dialect { temperature: Some(0.5), ..dialect() },
        Dialect { seed: Some(1), ..dialect() },
        Dialect { max_tokens: 17, ..dialect() },
    ];
    for dialect in changed {
        identities.push(chat_model(&chat.url(), "stub", dialect).identity());
    }
    identities.push(chat_model(&chat.url(), "other", dialect()).identity());
    identities
        .push(Remote::new(endpoint("http://127.0.0.1:1", "x"), "stub", Protocol::Chat(dialect())).identity());
    let distinct: std::collections::BTreeSet<&String> = identities.iter().collect();
    assert_eq!(distinct.len(), identities.len(), "{identities:#?}");
}

#[tokio::test]
async fn an_adapter_over_http_tells_every_fault_by_its_kind() {
    let raw = |status, headers: &[(&'static str, &'static str)], body: &str| Reply::Raw {
        status,
        headers: headers.to_vec(),
        body: body.to_owned(),
    };
    let html = [("content-type", "text/html")];
    let cases = [
        (raw(429, &[("retry-after", "7")], "{}"), Fault::Limited { retry_after: None }),
        (raw(429, &[], "{}"), Fault::Limited { retry_after: None }),
        (raw(503, &[("retry-after", "7")], "{}"), Fault::Limited { retry_after: None }),
        (raw(500, &[], "{}"), Fault::Failing(500)),
        (raw(401, &[], "{}"), Fault::Refused(401)),
        (raw(302, &[("location", "http://127.0.0.1:1/elsewhere")], ""), Fault::Refused(302)),
        (raw(200, &html, "<p>hello</p>"), Fault::Garbled("")),
        (raw(200, &[], "{\"choices\": [{\"mess"), Fault::Garbled("")),
        (raw(200, &[], "{\"choices\": []}"), Fault::Garbled("")),
        (Reply::Drop, Fault::Unreachable(String::new())),
    ];
    let chat = Stub::start(sensible).await;
    let vqa = vqa_model(&chat.url());
    let openai = chat_model(&chat.url(), "stub", dialect());
    let look = questions().swap_remove(3);
    for (reply, expected) in cases {
        let shown = format!("{reply:?}");
        chat.script(move |_| reply.clone());
        for model in [&vqa as &dyn Model, &openai] {
            let fault = model.answer(&look).await.expect_err(&shown);
            assert_eq!(discriminant(&fault), discriminant(&expected), "{shown}: {fault:?}");
        }
    }
    chat.script(|_| raw_429());
    let limited = openai.answer(&look).await;
    assert_eq!(limited, Err(Fault::Limited { retry_after: Some(Duration::from_secs(7)) }));
    let nobody = chat_model("http://127.0.0.1:1/v1", "stub", dialect());
    assert!(matches!(nobody.answer(&look).await, Err(Fault::Unreachable(_))));
}

fn raw_429() -> Reply {
    Reply::Raw { status: 429, headers: vec![("retry-after", "7")], body: String::new() }
}

#[tokio::test]
async fn a_dialect_changes_the_request_and_nothing_else() {
    let chat = Stub::start(sensible).await;
    let ask = async |dialect: Dialect, question: usize| -> Value {
        let model = chat_model(&chat.url(), "stub", dialect);
        model.answer(&questions()[question]).await.unwrap();
        chat.journal().pop().unwrap().body
    };
    let usual = ask(dialect(), 0).await;
    assert_eq!(usual["max_tokens"], 300);
    assert_eq!(usual["temperature"], 0.0);
    assert_eq!(usual.get("seed"), None);
    assert_eq!(usual["messages"][0]["role"], "system");
    let schema = &usual["response_format"]["json_schema"]["schema"]["properties"]["level"];
    assert_eq!(schema["enum"], json!([1, 2, 3, 4, 5]));

    let other = Dialect {
        token_parameter: TokenParameter::MaxCompletionTokens,
        temperature: None,
        seed: Some(7),
        response_format: ResponseFormat::JsonObject,
        system_role: SystemRole::Inline,
        image_form: ImageForm::PlainUri,
        ..dialect()
    };
    let body = ask(other.clone(), 0).await;
    assert_eq!(body["max_completion_tokens"], 300);
    assert_eq!((body.get("max_tokens"), body.get("temperature")), (None, None));
    assert_eq!(body["seed"], 7);
    assert_eq!(body["response_format"]["type"], "json_object");
    assert_eq!(body["messages"].as_array().unwrap().len(), 1);
    let seen = ask(other, 3).await;
    let image = seen["messages"][0]["content"][1]["image_url"].as_str().unwrap();
    assert!(image.starts_with("data:image/png;base64,"), "{image}");
    let blind = Dialect { image_form: ImageForm::None, ..dialect() };
    let blind = chat_model(&chat.url(), "stub", blind);
    assert!(!blind.can(Role::Vision) && blind.can(Role::Text));
}

#[tokio::test]
async fn a_vqa_server_gets_an_image_a_question_and_the_history() {
    let (_chat, vqa, models) = adapters().await;
    models[1].answer(&questions()[3]).await.unwrap();
    let body = vqa.journal().pop().unwrap().body;
    assert_eq!(body["question"], "Which number?");
    assert_eq!(body["history"], json!([{"question": "What does it show?", "answer": "a boat"}]));
    assert!(body["image"].as_str().is_some_and(|image| image.starts_with("iVBOR")), "{body}");
}

#[test]
fn an_address_with_a_password_or_of_another_kind_is_refused() {
    for address in ["http://me:secret@127.0.0.1/v1", "file:///etc/passwd", "127.0.0.1:80", "", "ftp://host/x"]
    {
        let refused = Endpoint::new(address, "x", None, Duration::from_secs(1)).expect_err(address);
        assert!(!refused.to_string().contains("secret"), "{refused}");
    }
}
