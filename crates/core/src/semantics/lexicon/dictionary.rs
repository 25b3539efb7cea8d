//! What a word is worth: proper to one object, descriptive, generic, or mere grammar.

use std::collections::HashMap;
use std::sync::LazyLock;

use crate::semantics::lexicon::generic;
use crate::semantics::lexicon::role;
use crate::semantics::lexicon::word_list::WordList;

/// The worth of a word, most telling first. The order is also the global token order of the blocking keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Class {
    /// Not in the dictionary: names and things.
    Specific,
    /// A count, measure, time or price.
    Quantity,
    /// Size, shape, age.
    Descriptive,
    /// A colour, a material or a number, of which a thing has one.
    Look,
    /// What every building has at every door.
    Generic,
    /// One letter: part of a name, and no word.
    Letter,
    /// Grammar, and the phrases of captioners ("a sign that says").
    Function,
}

/// Class of a stem as written, if the dictionary has it.
pub fn listed(stem: &str) -> Option<Class> {
    CLASSES.get(stem).copied()
}

/// Without the plural, and without a possessive; one spelling of a look.
pub fn stem(word: &str) -> String {
    const LOOKS: [(&str, &str); 4] =
        [("wooden", "wood"), ("metallic", "metal"), ("golden", "gold"), ("gray", "grey")];
    if let Some((_, look)) = LOOKS.iter().find(|(other, _)| *other == word) {
        return (*look).to_owned();
    }
    let word = word.strip_suffix("'s").unwrap_or(word).replace('\'', "");
    let plural = word.len() > 3
        && word.is_ascii()
        && word.ends_with('s')
        && !["ss", "us", "is"].iter().any(|e| word.ends_with(e));
    if plural { word[..word.len() - 1].to_owned() } else { word }
}

/// Whether this is a "no" or "not".
pub fn negates(word: &str) -> bool {
    NEGATIONS.has(word)
}

/// Whether this word says that the writer could not tell.
pub fn is_unsure(stem: &str) -> bool {
    UNSURE.has(stem)
}

/// Returns a verb or adjective that says the writer could not tell, when it is negated: "cannot *read*".
pub fn is_unsure_when_negated(stem: &str) -> bool {
    PERCEPTION.has(stem)
}

/// Splits a run of Han, Kana or Hangul into words of the dictionary, the longest first. None if something is left over.
pub fn split(run: &str) -> Option<Vec<&str>> {
    const LONGEST: usize = 10;
    let mut rest = run;
    let mut words = Vec::new();
    while !rest.is_empty() {
        let ends: Vec<usize> = rest.char_indices().skip(1).map(|(end, _)| end).take(LONGEST - 1).collect();
        let ends = ends.into_iter().chain((rest.chars().count() <= LONGEST).then_some(rest.len()));
        // One character may be part of any name.
        let is_word = |end: &usize| rest[..*end].chars().nth(1).is_some() && is_known(&rest[..*end]);
        let end = ends.filter(is_word).max()?;
        words.push(&rest[..end]);
        rest = &rest[end..];
    }
    Some(words)
}

fn is_known(word: &str) -> bool {
    listed(word).is_some() || negates(word)
}

static NEGATIONS: WordList = WordList::of(
    "no not none never without cannot can't don't doesn't isn't aren't won't non nor unable \
    prohibited forbidden kein keine keinen nicht ohne verboten pas sans interdit interdite sin prohibido prohibida vietato vietata divieto proibido proibida \
    verboden forbudt forbjudet zakaz zakazan yasak yasaktir запрещено запрещен воспрещен воспрещено απαγορευεται ممنوع אסור dilarang \
    禁止 严禁 嚴禁 请勿 請勿 금지 ห้าม",
);

static UNSURE: WordList = WordList::of(
    "unknown unclear unsure uncertain illegible unreadable unrecognizable unrecognisable indistinct \
    undefined undetermined unidentified indiscernible blurry blurred nothing null nil nan na unleserlich unbekannt \
    illisible inconnu ilegible desconocido 不明",
);

static PERCEPTION: WordList = WordList::of(
    "know read see tell say determine identify recognize recognise recognizable recognisable visible \
    legible readable discernible sure clear certain available applicable detected found text",
);

const FUNCTION: &str = "a an the of on in at to from by for with within into onto and or as is are was were be been being it its \
    this that these those there here has have had do does can could may might will would which who what where when \
    i you he she we they me my your his her their our us some any each one only also very near next beside besides adjacent alongside opposite behind above \
    below beneath underneath atop upon among amid toward towards under over between against during through across around along inside outside off out \
    read reading say saying show showing shown display displayed displaying depict depicting depicted portray portraying \
    portrayed illustrate illustrating illustrated represent representing represented include including included feature featuring \
    featured mark marked labeled labelled titled called numbered written painted printed engraved mounted hung hanging \
    attached located placed seen see visible indicate indicating appear bearing contain containing state stating like \
    am since est anno circa copyright established please be sorry because if then \
    der die das den dem des ein eine einen einem einer eines und oder im am an auf mit von vom zu zum zur fur bei aus \
    le la les l un une du de d et ou en au aux avec dans sur pour par ce cette \
    el los las unos unas y o del al con para por lo este esta di il della delle dello degli dei dos das uma em het een van voor och med til for n° number num no nr numero nummer zimmernummer raumnummer \
    の は が を に で と へ も из и в на с";

const GENERIC: &str = "exit push pull toilet restroom washroom bathroom wc lavatory men women man woman ladies gents lady gent \
    male female unisex stair staircase stairwell stairway lift elevator escalator extinguisher fire alarm emergency way \
    hydrant hose sprinkler smoke detector assembly point first aid defibrillator aed caution warning danger attention \
    notice wet smoking entry enter entrance reception lobby corridor hallway hall private staff authorized authorised \
    personnel open closed close welcome information info wifi please keep wait waiting area parking \
    sign signage signpost plate plaque label board panel poster painting picture image photo photograph print artwork \
    portrait landscape drawing canvas frame framed sketch illustration depiction mural watercolor watercolour snapshot engraving etching fresco \
    tapestry placard pintura dipinto immagine schilderij afbeelding peinture affiche dessin imagen quadro foto inscription caption lettering wall door doorway window ceiling ground floor object item thing \
    text word letter character font digit symbol logo icon arrow background foreground view scene closeup \
    do slide press button switch light handle knob lock key room meeting conference office kitchen storage \
    left right up down upstairs downstairs top bottom north south east west nord norte sud sued ost ouest oeste straight ahead back forward side corner middle center centre front distance \
    black-and-white close-up someone person people building shop store menu sale \
    ausgang eingang notausgang drucken ziehen aufzug fahrstuhl treppe toilette herren damen feuerloscher achtung \
    vorsicht privat schild bild gemalde tur wand rauchen zutritt links rechts oben unten \
    sortie entree pousser poussez tirer tirez ascenseur escalier toilettes extincteur secours issue panneau tableau \
    porte mur gauche droite haut bas fumer prive \
    salida entrada empuje empujar tire tirar ascensor escalera aseo bano extintor emergencia cuadro puerta pared \
    izquierda derecha arriba abajo fumar privado servicio \
    出口 入口 出入口 非常口 お手洗い 洗手间 卫生间 电梯 楼梯 エレベーター トイレ 階段 消火器 灭火器 押 引 推 拉 絵 立入 \
    左 右 上 下 北口 南口 東口 西口 화장실 출구 입구 계단 выход вход туалет лестница лифт дверь";

const LOOK: &str = "red green blue yellow orange purple violet pink brown black white grey gray silver gold golden beige turquoise \
    rot grun blau gelb schwarz weiss braun grau rouge vert verte bleu bleue jaune noir noire blanc blanche \
    rojo roja verde azul amarillo amarilla negro negra blanco blanca \
    wooden wood metal metallic steel brass bronze glass plastic paper stone brick concrete marble leather fabric ceramic \
    two three four five six seven eight nine ten";

const DESCRIPTIVE: &str = "big large small little tall short long wide narrow thin thick high low huge tiny round square \
    rectangular oval circular triangular flat curved old new modern ancient antique vintage beautiful nice pretty simple \
    plain colorful colourful bright dark pale dirty clean shiny matte rusty broken empty full single double multiple \
    several many few bold italic handwritten capital different same other \
    another main abstract";

static CLASSES: LazyLock<HashMap<String, Class>> = LazyLock::new(|| {
    let lists = [
        (Class::Descriptive, DESCRIPTIVE),
        (Class::Look, LOOK),
        (Class::Generic, GENERIC),
        (Class::Function, FUNCTION),
    ];
    let roles = role::words().chain(generic::words()).map(|word| (stem(word), Class::Generic));
    // Later lists win: "no" of "no. 5" is grammar before it is anything else.
    let words = lists
        .into_iter()
        .flat_map(|(class, words)| words.split_whitespace().map(move |word| (stem(word), class)));
    roles.chain(words).collect()
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_without_spaces_is_split_into_generic_words_or_not_at_all() {
        assert_eq!(split("安全出口禁止吸烟"), Some(vec!["安全出口", "禁止吸烟"]));
        assert_eq!(split("上野出口"), None);
        assert_eq!(split("会议室"), None);
    }
}
