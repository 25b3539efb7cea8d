//! Roles of a number: a room, a floor, a gate.

use std::collections::HashMap;
use std::sync::LazyLock;

use crate::semantics::lexicon::word_list::WordList;

/// The kind of thing that a number is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Role {
    /// A room or door, which every plate is of: the word says no more than "number" does.
    Room,
    /// A floor or level.
    Floor,
    /// Any other kind this module knows, by its English name: `gate`, `shelf`, `hub`.
    Place(&'static str),
    /// No word tells: a bare number.
    Neutral,
}

impl Role {
    /// Whether it numbers a part of a building that holds many objects.
    pub fn is_container(self) -> bool {
        self == Role::Floor || self.is_named_part()
    }

    /// Whether it is a part of a building that may have a name: "north wing", and not a floor.
    pub fn is_named_part(self) -> bool {
        matches!(self, Role::Place("building" | "wing" | "zone" | "section"))
    }

    /// Returns the English name, empty for [`Role::Neutral`].
    pub fn as_str(self) -> &'static str {
        match self {
            Role::Room => "room",
            Role::Floor => "floor",
            Role::Place(name) => name,
            Role::Neutral => "",
        }
    }
}

/// Returns the role a word names (lower case, without diacritics), also in the plural.
pub fn role_of(word: &str) -> Option<Role> {
    let of_singular = || BY_WORD.get(word.strip_suffix('s').filter(|singular| singular.len() > 2)?);
    BY_WORD.get(word).or_else(of_singular).copied()
}

/// Whether a word names a part of a building that holds many objects: "floor", "wing".
pub fn names_container(word: &str) -> bool {
    role_of(word).is_some_and(Role::is_container)
}

/// Returns the role that Han, Kana or Hangul straight after a number give it, as in 901号室, and the length of those
/// characters.
pub fn role_of_suffix(run: &str) -> Option<(Role, usize)> {
    SUFFIXES.iter().find(|(suffix, _)| run.starts_with(suffix)).map(|(suffix, role)| (*role, suffix.len()))
}

/// Words that only announce a number: "room *no.* 901".
pub fn is_number_label(word: &str) -> bool {
    static LABELS: WordList = WordList::of(
        "no nr num number # numero nummer numer nro nº n° nombor nomor broj cislo szam numeral code номер αριθμοσ αρ \
         رقم מספר หมายเลข 番号 번호",
    );
    LABELS.has(word)
}

/// Returns every role word that means nothing else where no number is beside it.
pub fn words() -> impl Iterator<Item = &'static str> {
    let words = ROLES.iter().flat_map(|(_, words)| words.split_whitespace());
    words.filter(|word| !HOMOGRAPHS.contains(word))
}

static BY_WORD: LazyLock<HashMap<&str, Role>> = LazyLock::new(|| {
    ROLES.iter().flat_map(|(role, words)| words.split_whitespace().map(move |word| (word, *role))).collect()
});

/// Role words of one language that are things in the descriptions of another: "piano 3" is a floor, and a piano is not.
const HOMOGRAPHS: [&str; 8] = ["camera", "gang", "mesa", "piano", "piece", "regal", "stock", "tor"];

const ROLES: &[(Role, &str)] = &[
    (
        Role::Room,
        "room rm door doorway zimmer zi zimmernummer raum raumnummer raume tur turen salle salles chambre porte piece \
         habitacion puerta sala cuarto stanza camera porta kamer lokaal rum rom vaerelse værelse huone szoba oda pokoj \
         pomieszczenie mistnost sal phong bilik ruang ruangan комната дверь помещение кімната стая δωματιο αιθουσα غرفة חדר \
         कमरा ห้อง 房间 房間 部屋",
    ),
    (
        Role::Place("office"),
        "office buro bureau oficina ufficio kantoor escritorio biuro kancelar iroda ofis кабинет офис γραφειο مكتب משרד",
    ),
    (Role::Place("apartment"), "apartment apt flat wohnung appartement apartamento квартира"),
    (Role::Place("suite"), "suite"),
    (Role::Place("classroom"), "classroom aula 教室"),
    (Role::Place("ward"), "ward"),
    (Role::Place("chamber"), "chamber"),
    (Role::Place("parlour"), "stube"),
    (
        Role::Floor,
        "floor level storey story fl lvl etage stock stockwerk geschoss obergeschoss og niveau piso planta piano andar \
         verdieping этаж 楼层",
    ),
    (Role::Place("gate"), "gate tor flugsteig ゲート 登机口"),
    (Role::Place("aisle"), "aisle gang allee pasillo"),
    (Role::Place("shelf"), "shelf shelves regal etagere estante"),
    (Role::Place("bay"), "bay"),
    (Role::Place("rack"), "rack"),
    (Role::Place("hub"), "hub"),
    (
        Role::Place("building"),
        "building bldg block gebaude haus batiment edificio house корпус блок здание строение κτιριο",
    ),
    (Role::Place("terminal"), "terminal"),
    (Role::Place("platform"), "platform gleis bahnsteig track quai voie anden via"),
    (Role::Place("seat"), "seat sitz sitzplatz siege asiento"),
    (Role::Place("table"), "table tisch mesa"),
    (Role::Place("desk"), "desk schreibtisch"),
    (Role::Place("locker"), "locker schliessfach casier taquilla"),
    (Role::Place("exit"), "exit ausgang sortie salida 出口"),
    (Role::Place("entrance"), "entrance eingang entree entrada"),
    (Role::Place("lift"), "lift elevator aufzug ascenseur ascensor"),
    (Role::Place("stairs"), "stair stairs staircase stairwell treppe escalier escalera"),
    (Role::Place("hall"), "hall halle"),
    (Role::Place("lab"), "lab laboratory labor laboratoire laboratorio"),
    (Role::Place("zone"), "zone zona"),
    (Role::Place("sector"), "sector sektor secteur"),
    (Role::Place("section"), "section abschnitt"),
    (Role::Place("wing"), "wing flugel aile крыло"),
    (Role::Place("row"), "row reihe rangee fila"),
    (Role::Place("column"), "column"),
    (Role::Place("lane"), "lane"),
    (Role::Place("line"), "line linie ligne linea"),
    (Role::Place("station"), "station"),
    (Role::Place("dock"), "dock"),
    (Role::Place("pier"), "pier"),
    (Role::Place("unit"), "unit"),
    (Role::Place("bin"), "bin"),
    (Role::Place("box"), "box"),
    (Role::Place("slot"), "slot"),
    (Role::Place("cabinet"), "cabinet schrank armoire"),
    (Role::Place("counter"), "counter schalter guichet"),
    (Role::Place("pillar"), "pillar saule pilier"),
    (Role::Place("parking"), "parking stellplatz"),
    (Role::Place("stop"), "stop"),
    (Role::Place("studio"), "studio"),
];

// Longest first.
const SUFFIXES: &[(&str, Role)] = &[
    ("号室", Role::Room),
    ("號室", Role::Room),
    ("号楼", Role::Place("building")),
    ("號樓", Role::Place("building")),
    ("号館", Role::Place("building")),
    ("号馆", Role::Place("building")),
    ("番線", Role::Place("platform")),
    ("号线", Role::Place("line")),
    ("号出口", Role::Place("exit")),
    ("番出口", Role::Place("exit")),
    ("号门", Role::Room),
    ("호실", Role::Room),
    ("번", Role::Neutral),
    ("号", Role::Room),
    ("號", Role::Room),
    ("室", Role::Room),
    ("호", Role::Room),
    ("階", Role::Floor),
    ("阶", Role::Floor),
    ("楼", Role::Floor),
    ("樓", Role::Floor),
    ("层", Role::Floor),
    ("層", Role::Floor),
    ("층", Role::Floor),
];
