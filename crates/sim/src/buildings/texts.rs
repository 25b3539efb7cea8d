//! Texts of buildings besides plates: notices, brands, pictures, pointers and directories.

/// Notices that a building hangs at many doors.
pub const NOTICES: [&str; 12] = [
    "Please keep this door closed",
    "Brandschutztür, bitte geschlossen halten",
    "Défense de fumer",
    "请随手关门",
    "開放厳禁",
    "출입문을 닫아 주세요",
    "Kérjük, csukja be az ajtót",
    "Pidä ovi suljettuna",
    "Παρακαλώ κλείνετε την πόρτα",
    "Küche sauber verlassen",
    "Mind your head",
    "Nur für Personal",
];

/// Invented brands and names that hang in many places.
pub const BRANDS: [&str; 8] = [
    "Nordwall Lifts",
    "Aqualine",
    "Mistral Hygiene",
    "Kaltenegg Sicherheit",
    "Veloura Coffee",
    "Lumetra",
    "Tessaro Clima",
    "Brightwick",
];

/// Pictures, as a model describes them.
pub const PICTURES: [&str; 6] = [
    "a framed print of a sailing boat before a windmill",
    "a picture of a red fox in the snow",
    "a framed photograph of a stone bridge over a river",
    "a painting of sunflowers in a blue vase",
    "a black and white photograph of a lighthouse",
    "a framed print of three birch trees in autumn",
];

/// Signs of every corridor.
pub const COMMON: [&str; 4] = ["EXIT", "Fire extinguisher", "WC", "Notausgang"];

/// Billboards across the street.
pub const BILLBOARDS: [&str; 4] =
    ["Harbour Bank", "Grand Hotel Meridian", "Stadtwerke Kundenzentrum", "Cinema Aurora"];

/// Returns the text of a pointer to doors.
pub fn pointer(first: &str, last: &str) -> String {
    format!("{first} - {last} \u{2192}")
}
