//! Golden tables: ways in which real buildings number their doors, each with its source.

use super::{Text, conflict, similarity};

/// One way to number doors.
struct Scheme {
    /// What it is, and where it is described or used.
    source: &'static str,
    /// Spellings of one name: level 4 or 5.
    same: &'static [(&'static str, &'static str)],
    /// Names that exclude each other: level 1, a conflict.
    different: &'static [(&'static str, &'static str)],
    /// One lacks a part, or nobody can tell: level 3 at most, no conflict.
    open: &'static [(&'static str, &'static str)],
}

#[test]
fn names_of_every_scheme_are_compared_part_by_part() {
    let mut failures = Vec::new();
    for scheme in SCHEMES {
        let kinds = [
            ("same", scheme.same, 4..=5, false),
            ("different", scheme.different, 1..=1, true),
            ("open", scheme.open, 1..=3, false),
        ];
        for (kind, pairs, levels, excludes) in kinds {
            for &(a, b) in pairs {
                let (text_a, text_b) = (Text::parse(a), Text::parse(b));
                for (from, to) in [(&text_a, &text_b), (&text_b, &text_a)] {
                    let level = similarity(from, to).level;
                    let is_conflict = conflict(from, to).is_some();
                    if !levels.contains(&level) || is_conflict != excludes {
                        let found = format!("level {level}, conflict {is_conflict}");
                        failures.push(format!("{kind}: {a:?} / {b:?}: {found} ({})", scheme.source));
                    }
                }
            }
        }
    }
    failures.dedup();
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures.join("\n"));
}

const SCHEMES: &[Scheme] = &[
    Scheme {
        source: "Letter of the building, three or four digits (C 202, D 1122), Brno: \
                 http://inzenyri.sweb.cz/novacek/mistnosti.htm",
        same: &[
            ("C 202", "C202"),
            ("C 202", "c-202"),
            ("C 202", "Room C 202"),
            ("D 1122", "Ｄ１１２２"),
            ("C 202", "C.202"),
        ],
        different: &[
            ("C 202", "B 202"),
            ("C 202", "C 219"),
            ("B 280", "B 286"),
            ("D 1122", "C 1122"),
            ("C 202", "C 220"),
        ],
        open: &[("C 202", "202"), ("D 1122", "1122"), ("C 202", "C 2O2"), ("A 101", "North 101")],
    },
    Scheme {
        source: "Building, floor as a letter, number (ML D 28), ETH Zurich: \
                 https://kreis7-8.spkantonzh.ch/aktuell/termine/hochschulquartier-eth-laedt-zum-dialog/",
        same: &[
            ("ML D 28", "ml d 28"),
            ("ML D 28", "ML D28"),
            ("ML D 28", "Raum ML D 28"),
            ("ML D 28", "ＭＬ Ｄ ２８"),
        ],
        different: &[
            ("ML D 28", "ML E 28"),
            ("ML D 28", "HG D 28"),
            ("ML D 28", "ML D 82"),
            ("ML E 32", "ML D 32"),
        ],
        open: &[("ML D 28", "D 28"), ("ML D 28", "28"), ("ML D 28", "ML 28"), ("ML D 28", "ML D 2B")],
    },
    Scheme {
        source: "Two letters of the building, floor and room in three digits (LH404), Northampton: \
                 https://askus.northampton.ac.uk/faq/241877",
        same: &[("LH404", "LH 404"), ("LH404", "lh404"), ("LH404", "LH-404"), ("LH404", "Room LH404")],
        different: &[("LH404", "CH404"), ("LH404", "LH440"), ("SN104", "SZ104"), ("LH404", "LH304")],
        open: &[("LH404", "404"), ("LH404", "LH4O4"), ("LH404", "L404")],
    },
    Scheme {
        source: "Two letters and digits that keep their zeros, B for the basement (QB022), Roehampton: \
                 http://www.roehampton.ac.uk/about/staffdirectory/key.asp",
        same: &[("QB022", "QB 022"), ("QB022", "qb022"), ("QB022", "QB 22"), ("QB022", "ＱＢ０２２")],
        different: &[("QB022", "QB220"), ("QB022", "QC022"), ("QB022", "QB002"), ("QB022", "RB022")],
        open: &[("QB022", "022"), ("QB 022", "QB O22"), ("QBB22", "QB822")],
    },
    Scheme {
        source: "Building, hyphen, room; letters for the side of the campus (10-250, E25-111, NE43-200), \
                 MIT: \
                 http://web.mit.edu/ofms-space/www/textdocs/wrid.html",
        same: &[
            ("10-250", "Room 10-250"),
            ("10-250", "１０－２５０"),
            ("E25-111", "E 25-111"),
            ("NE43-200", "ne43-200"),
        ],
        different: &[
            ("10-250", "10-205"),
            ("10-250", "16-250"),
            ("E25-111", "W25-111"),
            ("NE43-200", "NW43-200"),
            ("5-212", "2-512"),
        ],
        open: &[("10-250", "10.250"), ("10-250", "10250"), ("E25-111", "25-111"), ("E25-111", "E25")],
    },
    Scheme {
        source: "Building and room in three digits each (260-098), Auckland: \
                 https://www.samsuoa.com/post/finding-your-way-around-uni",
        same: &[("260-098", "Room 260-098"), ("260-098", "260-98"), ("260-098", "２６０－０９８")],
        different: &[
            ("260-098", "260-089"),
            ("260-098", "206-098"),
            ("505-007", "505-070"),
            ("260-098", "260-908"),
        ],
        open: &[("260-098", "260.098"), ("260-098", "260098"), ("260-098", "26O-098")],
    },
    Scheme {
        source: "Floor, kind of room, number (1C1 corridor, 1S1 stairs, 1E1 lift), Virginia: \
                 https://fmd.vcu.edu/service-guide/name-265968-en.html",
        same: &[("1C1", "1c1"), ("1C1", "1 C 1"), ("1E1", "1-E-1"), ("1S2", "１Ｓ２")],
        different: &[("1C1", "1E1"), ("1C1", "2C1"), ("1E1", "1E2"), ("1C1", "1C2"), ("1S1", "1E1")],
        open: &[("1C1", "C1"), ("1S1", "151"), ("1C1", "1-1")],
    },
    Scheme {
        source: "Floor, side, number (2L02, 6L01), Showa Women's University: \
                 https://content.swu.ac.jp/kanekotomoko/2017/02/10/",
        same: &[("2L02", "2 L 02"), ("2L02", "2l02"), ("2L02", "2L2"), ("6L01", "６Ｌ０１")],
        different: &[("2L02", "6L02"), ("2L02", "2L20"), ("2L02", "2R02"), ("6L01", "6L02")],
        open: &[("2L02", "L02"), ("2L02", "2-02"), ("2L02", "2LO2")],
    },
    Scheme {
        source: "Letter, floor, wing, number (J3A03; the list has 3C03 for J3C03), Chung Hsing: \
                 https://onepiece.nchu.edu.tw/cofsys/plsql/crseqry_room_map2?v_build_code=J",
        same: &[
            ("J3A03", "J 3A03"),
            ("J3A03", "j3a03"),
            ("J3A03", "J-3-A-03"),
            ("J3A03", "Room J3A03"),
            ("S1022A", "S1022 A"),
        ],
        different: &[
            ("J3A03", "J3D03"),
            ("J3A03", "J4A03"),
            ("J3A03", "C3A03"),
            ("J3A03", "J3A04"),
            ("S1022A", "S1022B"),
        ],
        open: &[("J3C03", "3C03"), ("J3A03", "J3A"), ("J3A03", "J3-03"), ("S1022A", "S1022")],
    },
    Scheme {
        source: "Letter behind the number for the room in a suite (237B), Ferris State: \
                 http://ferris.edu/HTMLS/studentlife/reslife/halls/eastcampussuites/ecs_living_guide/\
                 suite_numbering_system.htm",
        same: &[("237B", "237 B"), ("237B", "237b"), ("237B", "237-B"), ("237B", "Room 237B")],
        different: &[("237B", "237A"), ("237B", "327B"), ("237B", "236B"), ("12 A", "12 B")],
        open: &[("237B", "237"), ("237B", "B237"), ("237B", "2378"), ("12", "12 A")],
    },
    Scheme {
        source: "Number, hyphen, letter (253-D, 237-C, 112-N), Parliament in Ottawa: \
                 https://ourcommons.ca/About/BuildingTheFuture/FigureE-e.html",
        same: &[("253-D", "253D"), ("253-D", "253 d"), ("112-N", "Room 112-N"), ("253-D", "２５３－Ｄ")],
        different: &[("253-D", "253-C"), ("112-N", "112-S"), ("253-D", "235-D"), ("237-C", "237-D")],
        open: &[("253-D", "253"), ("112-N", "North 112"), ("112-N", "N-112")],
    },
    Scheme {
        source: "Floor, side of the house, number (5E180, 5W100), hospital in Toronto: \
                 https://foundation.hollandbloorview.ca/services/family-workshops-resources/\
                 family-resource-centre/online-family-resources-centre/indoor",
        same: &[("5E180", "5 E 180"), ("5E180", "5e180"), ("5W100", "5-W-100"), ("5E180", "Room 5E180")],
        different: &[("5E180", "5W180"), ("5E180", "4E180"), ("5E180", "5E108"), ("4E100", "4W100")],
        open: &[("5E180", "E180"), ("5E180", "5E"), ("5E180", "5-180"), ("5E180", "SE180")],
    },
    Scheme {
        source: "Letter of the site and four digits (N 1643, S 0423), TU Munich: \
                 http://www.ar.tum.de/fakultaet/orientierung/",
        same: &[
            ("N 1643", "N1643"),
            ("N 1643", "Raum N 1643"),
            ("S 0423", "s-0423"),
            ("N 1643", "Ｎ １６４３"),
        ],
        different: &[("N 1643", "S 1643"), ("N 1643", "N 1634"), ("S 0423", "S 4023"), ("N 1643", "N 3643")],
        open: &[("N 1643", "1643"), ("N 1643", "North 1643"), ("S 0423", "S O423")],
    },
    Scheme {
        source: "Two groups of digits with a blank (26 402), TU Munich, chemistry: \
                 https://wwwt3.ch.tum.de/en/zentral/electronics-workshop/floor-plan/",
        same: &[("26 402", "Room 26 402"), ("26 402", "Raum 26 402"), ("26 402", "２６ ４０２")],
        different: &[("26 402", "26 403"), ("26 402", "16 402"), ("26 402", "26 420")],
        open: &[("26 402", "26402"), ("26 402", "26-402"), ("26 402", "26 4O2")],
    },
    Scheme {
        source: "Campus, hyphen, part of the building, number with its zeros (AR-F 002, AR-H 108), Siegen: \
                 http://home.fsr-chemie-bio.de/infos-fuer-ersties/orientierung-auf-den-campussen/",
        same: &[
            ("AR-F 002", "AR-F002"),
            ("AR-F 002", "ar-f 002"),
            ("AR-F 002", "AR-F 2"),
            ("AR-H 108", "Raum AR-H 108"),
        ],
        different: &[
            ("AR-F 002", "AR-H 002"),
            ("AR-F 002", "ENC-F 002"),
            ("AR-H 108", "AR-H 180"),
            ("AR-G 0117", "AR-G 0171"),
        ],
        open: &[("AR-F 002", "F 002"), ("AR-H 108", "108"), ("AR-H 108", "AR-H 1O8")],
    },
    Scheme {
        source: "Building, part, floor, room in dotted pairs of digits (23.31.02.26, 23.31.U1.26), \
                 Duesseldorf: \
                 http://www.phil-fak.uni-duesseldorf.de/studium/fachschaften/antike-kultur/campusplan/",
        same: &[
            ("23.31.02.26", "Raum 23.31.02.26"),
            ("23.31.02.26", "２３．３１．０２．２６"),
            ("23.31.U1.26", "23.31.u1.26"),
            ("23.31.02.26", "23.31.2.26"),
        ],
        different: &[
            ("23.31.02.26", "23.31.01.26"),
            ("23.31.02.26", "23.13.02.26"),
            ("23.31.02.26", "23.31.02.62"),
            ("23.31.U1.26", "23.31.U2.26"),
        ],
        open: &[
            ("23.31.02.26", "23310226"),
            ("23.31.02.26", "02.26"),
            ("23.31.U1.26", "23.31.1.26"),
            ("23.31.02.26", "23.31.02-26"),
        ],
    },
    Scheme {
        source: "Colour and entrance, colour and floor, corridor and room (S05 R00 L87), Essen: \
                 https://www.uni-due.de/chemie-fachschaft/raumnummern",
        same: &[
            ("S05 R00 L87", "S05R00L87"),
            ("S05 R00 L87", "s05 r00 l87"),
            ("S05 R00 L87", "S05-R00-L87"),
            ("R11 T07 D05", "Raum R11 T07 D05"),
        ],
        different: &[
            ("S05 R00 L87", "S05 T00 L87"),
            ("S05 R00 L87", "V05 R00 L87"),
            ("S05 R00 L87", "S05 R01 L87"),
            ("S05 R00 L87", "S05 R00 L78"),
            ("S05 T00 B59", "S05 T00 D59"),
        ],
        open: &[("S05 R00 L87", "R00 L87"), ("S05 R00 L87", "L87"), ("S05 R00 L87", "SO5 R00 L87")],
    },
    Scheme {
        source: "Site, slash, room, suffix (1/367A), the older names in Chemnitz: \
                 https://tu-chemnitz.de/stura/fibel/uni/raumbenennung",
        same: &[
            ("1/367A", "1/367 A"),
            ("1/367A", "1/367a"),
            ("1/367A", "Raum 1/367A"),
            ("1/367A", "１／３６７Ａ"),
        ],
        different: &[("1/367A", "2/367A"), ("1/367A", "1/367B"), ("1/367A", "1/376A")],
        open: &[("1/367A", "367A"), ("1/367A", "1/367"), ("1/367A", "1-367A")],
    },
    Scheme {
        source: "Letter and building, room, part of the room (C10.112, A10.367.1), the newer names in \
                 Chemnitz: \
                 https://tu-chemnitz.de/stura/fibel/uni/raumbenennung",
        same: &[
            ("A10.367.1", "A 10.367.1"),
            ("C10.112", "c10.112"),
            ("C10.112", "C-10.112"),
            ("E05.004", "Raum E05.004"),
            ("E05.004", "E5.4"),
        ],
        different: &[
            ("C10.112", "A10.112"),
            ("A10.367.1", "A10.367.2"),
            ("C10.112", "C11.112"),
            ("C10.112", "C10.121"),
            ("C10.112", "C1.0112"),
        ],
        open: &[
            ("A10.367.1", "A10.367"),
            ("C10.112", "10.112"),
            ("C10.112", "C10112"),
            ("C10.112", "C10-112"),
        ],
    },
    Scheme {
        source: "Square and side, floor, room (4SW.5.12, 5NW.6.12), Essex: \
                 http://www.essex.ac.uk/about/campuses/find_your_way/colchester.aspx",
        same: &[
            ("4SW.5.12", "4 SW.5.12"),
            ("4SW.5.12", "4sw.5.12"),
            ("4SW.5.12", "4SW 5.12"),
            ("5.512", "Room 5.512"),
        ],
        different: &[
            ("4SW.5.12", "4NW.5.12"),
            ("4SW.5.12", "5SW.5.12"),
            ("4SW.5.12", "4SW.5.21"),
            ("5.512", "5.521"),
        ],
        open: &[("4SW.5.12", "5.12"), ("4SW.5.12", "4SW.5"), ("4SW.5.12", "4SW.5-12"), ("5.512", "5512")],
    },
    Scheme {
        source: "Two letters of the wing and a floor, hyphen, room (BN1-12, BNB-04, BEG-07), Cambridge \
                 engineering: \
                 http://www.eng.cam.ac.uk/admin/room_numbering.html",
        same: &[("BN1-12", "BN 1-12"), ("BN1-12", "bn1-12"), ("BN1-12", "BN-1-12"), ("BEG-07", "BEG 07")],
        different: &[("BN1-12", "BS1-12"), ("BN1-12", "BN2-12"), ("BN1-12", "BN1-21"), ("BEG-07", "BEM-07")],
        open: &[("BN1-12", "1-12"), ("BN1-12", "BN1.12"), ("BN1-12", "BN112"), ("BNB-04", "BN8-04")],
    },
    Scheme {
        source: "Site, underscore, block, floor and room, part (HH_302, PR_B502B, PR_B501-01, HH_LG05), \
                 London arts: \
                 https://wiki.cci.arts.ac.uk/books/buildings/page/how-do-ual-room-numbers-work",
        same: &[
            ("HH_302", "hh_302"),
            ("PR_B502B", "PR_B502 B"),
            ("PR_B501-01", "PR_B 501-01"),
            ("HH_LG05", "HH_LG 05"),
        ],
        different: &[
            ("HH_G03", "GB_G03"),
            ("PR_B502B", "PR_B502A"),
            ("PR_B501-01", "PR_B501-02"),
            ("PR_A215", "PR_B215"),
        ],
        open: &[("HH_302", "302"), ("PR_B502B", "PR_B502"), ("HH_LG05", "LG05"), ("PR_B501-01", "PR_B501")],
    },
    Scheme {
        source: "Lower ground, ground and numbered floors as they stand on the lift's buttons (LG05): \
                 https://wiki.openstreetmap.org/Key:level:ref",
        same: &[("LG05", "LG 05"), ("LG05", "lg05"), ("LG05", "LG.05"), ("LG05", "LG-5")],
        different: &[("LG05", "LG50"), ("LG05", "UG05"), ("LG05", "LG06")],
        open: &[("LG05", "05"), ("LG 05", "LG O5"), ("Room LG05", "Room 5")],
    },
    Scheme {
        source: "Letters of the building, floor, dot, room (H0.90, WA1.05, FABM.02), Warwick; some plans \
                 drop the dot: \
                 https://warwick-wiki.containers.uwcs.co.uk/w/index.php?oldid=4331&title=Room_naming_systems",
        same: &[
            ("H0.90", "H 0.90"),
            ("H0.90", "h0.90"),
            ("WA1.05", "WA 1.05"),
            ("WA1.05", "WA-1.05"),
            ("D1.02", "D 1.02"),
        ],
        different: &[
            ("H0.90", "A0.90"),
            ("H0.90", "H1.90"),
            ("WA1.05", "WE1.05"),
            ("D1.02", "D1.20"),
            ("D1.02", "D10.2"),
        ],
        open: &[("D1.02", "D102"), ("H0.90", "0.90"), ("H0.90", "HO.90"), ("WA1.05", "WA1-05")],
    },
    Scheme {
        source: "Letter of the floor, ground or first (G12, F12), Millburn House in Warwick: \
                 https://warwick-wiki.containers.uwcs.co.uk/w/index.php?oldid=4301&title=Room_naming_systems",
        same: &[("G.12", "G12"), ("G12", "G 12"), ("G12", "g-12"), ("G12", "Room G12")],
        different: &[("G12", "F12"), ("G.12", "G.21"), ("G12", "H12")],
        open: &[("G12", "12"), ("G12", "612"), ("G12", "Ground 12"), ("G.12", "G.1Z")],
    },
    Scheme {
        source: "Floor, dot, room, so that 2.15 is not 21.5, as encyclopedias tell: \
                 https://daniellawrencek2ja.web.app/piece/rooms-numbered-by-floor.html",
        same: &[("2.15", "Room 2.15"), ("2.15", "No. 2.15"), ("1.02", "1.2"), ("1.02", "１．０２")],
        different: &[
            ("2.15", "21.5"),
            ("1.02", "10.2"),
            ("2.15", "2.51"),
            ("1.02", "2.01"),
            ("1.02", "1.20"),
        ],
        open: &[("1.02", "102"), ("1.02", "1-02"), ("2.15", "2 15"), ("2.15", "2.I5")],
    },
    Scheme {
        source: "Building, floor, room, all in digits (4.3.33), Lisbon: \
                 https://ciencias.ulisboa.pt/en/study-rooms",
        same: &[("4.3.33", "Room 4.3.33"), ("4.3.33", "Sala 4.3.33"), ("4.3.33", "４．３．３３")],
        different: &[("4.3.33", "4.3.32"), ("4.3.33", "3.4.33"), ("4.3.35", "4.3.53"), ("4.3.33", "4.33.3")],
        open: &[("4.3.33", "4333"), ("4.3.33", "4-3-33"), ("4.3.33", "3.33")],
    },
    Scheme {
        source: "Letter of the wing, floor, room, all dotted (A.1.6), school in Milan: \
                 https://www.liceovittorioveneto.edu.it/pagine/denominazione-degli-spazi",
        same: &[("A.1.6", "A 1.6"), ("A.1.6", "a.1.6"), ("A.1.6", "A1.6"), ("B.2.4", "Ｂ．２．４")],
        different: &[("A.1.6", "B.1.6"), ("A.1.6", "A.6.1"), ("B.2.4", "B.2.5"), ("C.3.2", "C.2.3")],
        open: &[("A.1.6", "1.6"), ("A.1.6", "A.16"), ("A.1.6", "A.1-6")],
    },
    Scheme {
        source: "Building and area, dot, floor and room (A21.304, B11.312), Tra Vinh: \
                 https://daotao.tvu.edu.vn/index.php/tu-dien-phong-hoc-truong-dai-hoc-tra-vinh/\
                 so-do-phong-hoc-cac-khu",
        same: &[
            ("A21.304", "A 21.304"),
            ("A21.304", "Phòng A21.304"),
            ("A21.304", "a21.304"),
            ("B11.312", "B-11.312"),
        ],
        different: &[
            ("A21.304", "B21.304"),
            ("A21.304", "A12.304"),
            ("A21.304", "A21.403"),
            ("B11.312", "B12.312"),
            ("A2.304", "A23.04"),
        ],
        open: &[("A21.304", "21.304"), ("A21.304", "A21-304"), ("A21.304", "A21304"), ("B11.312", "BI1.312")],
    },
    Scheme {
        source: "Mezzanine, basement and ground as letters before the room (M12), New South Wales: \
                 http://estatedocbox.com/Apartments/\
                 74968012-Room-numbering-standards-version-1-6-jan-2015.html",
        same: &[("M12", "M 12"), ("M12", "m-12"), ("M12", "M.12"), ("M12", "Room M12")],
        different: &[("M12", "G12"), ("M12", "M21"), ("M12", "N12")],
        open: &[("M12", "12"), ("M12", "Mezzanine 12"), ("M12", "MI2"), ("B12", "812")],
    },
    Scheme {
        source: "Levels below the ground, hyphen, room (L1-01, L2-35), Arizona State: \
                 http://www.asu.edu/aad/manuals/cpm/cpm317table1.html",
        same: &[("L2-35", "L 2-35"), ("L2-35", "l2-35"), ("L1-01", "L1-1"), ("L2-35", "Room L2-35")],
        different: &[("L2-35", "L1-35"), ("L2-35", "L2-53"), ("L2-35", "P2-35"), ("L1-01", "L1-10")],
        open: &[("L2-35", "2-35"), ("L2-35", "L2.35"), ("L2-35", "L235"), ("B1-03", "81-03")],
    },
    Scheme {
        source: "Building, floor, side and room with hyphens (BEIT-01-N106, BEIT-01-N103B), Imperial \
                 College: \
                 https://www.imperialcollegeunion.org/activities/committee-support-hub/room-bookings/\
                 bookable-spaces",
        same: &[
            ("BEIT-01-N106", "BEIT 01 N 106"),
            ("BEIT-01-N106", "beit-01-n106"),
            ("BEIT-01-N103B", "BEIT-01-N103 B"),
            ("BLKT 539", "BLKT539"),
        ],
        different: &[
            ("BEIT-01-N106", "BEIT-01-S106"),
            ("BEIT-01-N106", "BEIT-02-N106"),
            ("BEIT 539", "BLKT 539"),
            ("BEIT-01-N103B", "BEIT-01-N103A"),
        ],
        open: &[
            ("BEIT-01-N106", "N106"),
            ("BEIT-01-N103B", "BEIT-01-N103"),
            ("BLKT 539", "539"),
            ("N-213", "213"),
        ],
    },
    Scheme {
        source: "Building, colon, block and room, part of the room (T9:312a, TH:A-1333), Prague: \
                 https://help.fit.cvut.cz/rooms/misc/gtf-kos-keys.html",
        same: &[
            ("T9:312a", "T9:312A"),
            ("T9:312a", "T9:312 a"),
            ("TH:A-1333", "th:a-1333"),
            ("TH:A-1333", "TH:A 1333"),
        ],
        different: &[
            ("T9:312a", "T9:312b"),
            ("T9:312", "T9:321"),
            ("TH:A-1333", "TH:B-1333"),
            ("T9:312", "T2:312"),
        ],
        open: &[("T9:312a", "T9:312"), ("T9:312", "312"), ("TH:A-1333", "A-1333")],
    },
    Scheme {
        source: "Gate with the letter of the concourse, which some leave out (A11B, G97), San Francisco: \
                 https://crankyflier.com/2019/10/17/san-francisco-shuffles-its-gate-numbers/",
        same: &[
            ("Gate B12", "Gate B 12"),
            ("Gate B12", "GATE B12"),
            ("Gate B12", "gate b-12"),
            ("Gate A11B", "Gate A11 B"),
        ],
        different: &[
            ("Gate B12", "Gate C12"),
            ("Gate B12", "Gate B21"),
            ("Gate A11B", "Gate A11A"),
            ("Gate 12 to Paris", "Gate 12 to London"),
            ("Gate 12", "Terminal 12"),
        ],
        open: &[
            ("Gate G97", "Gate 97"),
            ("Gate B12", "B12"),
            ("Gate A11B", "Gate A11"),
            ("Gate 12 to Paris", "Gate 12"),
        ],
    },
    Scheme {
        source: "Exits with a letter by quarter, and a number if there are several (A, A1, B2), Beijing: \
                 https://shouchaobaoquan.com/item/sMmM4YzI4MWQ5YzAwN2M0MTA4MjUyYWNih.html",
        same: &[
            ("Exit A1", "EXIT A1"),
            ("Exit A1", "Exit A 1"),
            ("A1出口", "A1 出口"),
            ("Exit A1", "Ｅｘｉｔ Ａ１"),
        ],
        different: &[
            ("Exit A1", "Exit B1"),
            ("Exit A1", "Exit A2"),
            ("EXIT 3", "TOILET 3"),
            ("A1出口", "B1出口"),
        ],
        open: &[("Exit A1", "A1"), ("Exit A1", "Exit A"), ("Exit A1", "Exit 1")],
    },
    Scheme {
        source: "Numbered exits, named with their station (강남역 10번 출구), Seoul: \
                 https://juso24.info/article/navigating-korean-subway-exit-numbers",
        same: &[
            ("10번 출구", "10번출구"),
            ("10번 출구", "１０번 출구"),
            ("강남역 10번 출구", "강남역 10번출구"),
        ],
        different: &[
            ("10번 출구", "5번 출구"),
            ("10번 출구", "11번 출구"),
            ("강남역 10번 출구", "강남역 11번 출구"),
        ],
        open: &[("10번 출구", "10"), ("10번 출구", "강남역 10번 출구")],
    },
    Scheme {
        source: "Number and 호 (102호, 344호), Ewha law school: \
                 https://lawschool.ewha.ac.kr/lawschool/board/juris-all.do",
        same: &[("102호", "102 호"), ("102호", "１０２호"), ("법학관 102호", "법학관 102 호")],
        different: &[("102호", "104호"), ("201호", "102호"), ("344호", "434호")],
        open: &[("102호", "법학관 102호"), ("344호", "국제관 344호"), ("101호", "1O1호")],
    },
    Scheme {
        source: "Block and flat (101동 1203호), Korean housing estates: http://ziiumpnv.com/c2/1080",
        same: &[
            ("101동 1203호", "101동1203호"),
            ("101동 1203호", "１０１동 １２０３호"),
            ("101동 1203호", "101 동 1203 호"),
        ],
        different: &[
            ("101동 1203호", "102동 1203호"),
            ("101동 1203호", "101동 1302호"),
            ("101동 1203호", "101동 1204호"),
        ],
        open: &[("101동 1203호", "1203호"), ("101동 1203호", "101동")],
    },
    Scheme {
        source: "Building, floor and room in one number, and 教室 (2505教室), Tokyo Denki: \
                 https://tdu-navi.sg.dendai.ac.jp/read-room-number",
        same: &[("2505教室", "2505 教室"), ("2505教室", "２５０５教室"), ("2号館 2505教室", "2号館2505教室")],
        different: &[
            ("2505教室", "5402教室"),
            ("2505教室", "2506教室"),
            ("21005教室", "21001教室"),
            ("2号館 101教室", "3号館 101教室"),
        ],
        open: &[("2505教室", "2505"), ("2505教室", "2号館 2505教室"), ("2505教室", "25O5教室")],
    },
    Scheme {
        source: "Number and 号室, the wing in front (901号室, 西棟 901号室), hotels in Japan: \
                 https://sunset-hill.jp/hotel-room-number-safety-culture",
        same: &[
            ("901号室", "９０１号室"),
            ("901号室", "901 号室"),
            ("901号室", "room 901"),
            ("西棟 901号室", "西棟901号室"),
        ],
        different: &[
            ("901号室", "910号室"),
            ("203号室", "205号室"),
            ("西棟 901号室", "東棟 901号室"),
            ("A棟 901号室", "B棟 901号室"),
        ],
        open: &[("901号室", "西棟 901号室"), ("A棟 901号室", "901号室"), ("901号室", "9O1号室")],
    },
    Scheme {
        source: "Building, number sign, room (3#202), Zhuhai: \
                 https://bkwk.cn/article/jmzhkjxyjmgxmpbhdszmm-a17615815.html",
        same: &[("3#202", "３＃２０２"), ("3#202", "3 # 202"), ("教1 301", "教 1 301")],
        different: &[("3#202", "2#202"), ("3#202", "3#203"), ("3#202", "3#220"), ("教1 301", "实1 301")],
        open: &[("3#202", "202"), ("3#202", "3-202"), ("3#202", "3#2O2")],
    },
    Scheme {
        source: "Campus, block, staircase, room (东校区-3栋-2单元-301), Hubei: \
                 https://www.rlut.cn/news/\
                 hu-bei-li-gong-xue-yuan-su-she-bian-hao-jie-xi-yu-shi-yong-zhi-nan.html",
        same: &[
            ("东校区-3栋-2单元-301", "东校区 3栋 2单元 301"),
            ("3栋-2单元-301", "3栋2单元301"),
            ("3栋-2单元-301", "３栋－２单元－３０１"),
        ],
        different: &[
            ("东校区-3栋-2单元-301", "西校区-3栋-2单元-301"),
            ("3栋-2单元-301", "2栋-2单元-301"),
            ("3栋-2单元-301", "3栋-1单元-301"),
            ("3栋-2单元-301", "3栋-2单元-302"),
        ],
        open: &[("东校区-3栋-2单元-301", "3栋-2单元-301"), ("3栋-2单元-301", "2单元-301")],
    },
    Scheme {
        source: "Floor in Chinese or Arabic digits, then the room (五樓14號, 生有樓5樓; 五楼 514室), Taiwan: \
                 https://ve.wfu.edu.tw/?page_id=202",
        same: &[
            ("五樓14號", "5樓14號"),
            ("五楼 514室", "5楼 514室"),
            ("三楼 301室", "三楼301室"),
            ("五樓14號", "五樓１４號"),
        ],
        different: &[
            ("五樓14號", "四樓14號"),
            ("五樓14號", "五樓41號"),
            ("三楼 301室", "二楼 301室"),
            ("三楼 301室", "三楼 310室"),
        ],
        open: &[("五樓14號", "14號"), ("三楼 301室", "301室")],
    },
    Scheme {
        source: "Cyrillic letter of the building (\u{410}-100, Б-100), MEPhI: \
                 http://wiki.mephist.ru/wiki?title=%D0%91-100",
        same: &[
            ("\u{410}-100", "A-100"),
            ("Б-100", "Б100"),
            ("Б-100", "б 100"),
            ("Аудитория Б-100", "аудитория Б 100"),
            ("\u{412}-100", "B-100"),
        ],
        different: &[
            ("\u{410}-100", "Б-100"),
            ("Б-100", "\u{412}-100"),
            ("Б-100", "Б-101"),
            ("Б-100", "B-100"),
        ],
        open: &[("Б-100", "100"), ("\u{410}-100", "100"), ("Б-100", "Б-10O")],
    },
    Scheme {
        source: "Number before or behind the word (23 кабинет, кабинет № 23), outpatient clinics in Russia: \
                 https://pro-firmy.ru/poliklinika-1-rayonnaya-bolnica-1-otzyvy/otzyv-268653",
        same: &[
            ("кабинет 23", "Кабинет № 23"),
            ("каб. 214", "Каб.214"),
            ("кабинет 214а", "КАБИНЕТ 214 А"),
            ("23 кабинет", "２３ кабинет"),
        ],
        different: &[
            ("кабинет 23", "кабинет 32"),
            ("каб. 214", "каб. 215"),
            ("кабинет 214а", "кабинет 214б"),
        ],
        open: &[("кабинет 214", "кабинет 214а"), ("кабинет 214", "214"), ("каб. 214", "214")],
    },
    Scheme {
        source: "Building in Roman digits, block as a letter (IV корпус, блок В), Moscow: \
                 https://uzaomos.news/news/society/gumanitarnyy_korpus_mgu_vveli_v_ekspluatatsiyu",
        same: &[
            ("Building IV room 12", "building iv Room 12"),
            ("Building IV room 12", "Building Ⅳ room 12"),
            ("Building IV room 12", "Building IV, Room 12"),
            ("корпус IV аудитория 12", "Корпус IV Аудитория 12"),
        ],
        different: &[
            ("Building IV room 12", "Building VI room 12"),
            ("Building IV room 12", "Building IV room 21"),
            ("корпус IV аудитория 12", "корпус VI аудитория 12"),
            ("корпус IV блок В", "корпус IV блок Б"),
        ],
        open: &[
            ("Building IV room 12", "room 12"),
            ("корпус IV аудитория 12", "аудитория 12"),
            ("Building IV room 12", "Building IV"),
        ],
    },
    Scheme {
        source: "Rooms in Roman digits (Room XIX, Salle XIV), Palais des Nations in Geneva: \
                 https://dokumen.tips/documents/\
                 the-conference-rooms-23-le-palais-des-nations-the-palais-des-nations-building4.html",
        same: &[("Room XIX", "ROOM XIX"), ("Room XIX", "Salle XIX"), ("Room XIV", "Room ⅩⅣ")],
        different: &[
            ("Room XIX", "Room XXI"),
            ("Room XIV", "Room XVI"),
            ("Salle III", "Salle IV"),
            ("Room XIX", "Room XX"),
        ],
        open: &[("Salle III", "Bâtiment A Salle III"), ("Room XIX", "Building E Room XIX")],
    },
    Scheme {
        source: "Greek letters of the halls (Σ1, Σ5, \u{392}3, \u{392}4), Patras: \
                 https://arch.upatras.gr/en/node/7285",
        same: &[
            ("Σ1", "σ1"),
            ("Σ1", "Σ 1"),
            ("\u{392}3", "B3"),
            ("Αίθουσα \u{392}3", "\u{392}3"),
            ("\u{391}101", "A 101"),
        ],
        different: &[("Σ1", "Σ2"), ("\u{392}3", "\u{392}4"), ("Σ3", "\u{392}3"), ("Γ101", "\u{391}101")],
        open: &[("\u{391}101", "101"), ("Αίθουσα Σ12", "Αίθουσα 12"), ("\u{392}12", "812")],
    },
    Scheme {
        source: "Digits of the Arab east on buildings and lifts (١٦, ٢٠١): \
                 http://thekulas.blogspot.com/2010/07/do-you-know-your-arabic-numbers.html",
        same: &[
            ("قاعة ١٦", "قاعة 16"),
            ("٢٠١", "201"),
            ("غرفة ٢٠١", "Room 201"),
            ("A ٢٠١", "A201"),
            ("۲۰۱", "201"),
        ],
        different: &[("قاعة ١٦", "قاعة ٦١"), ("٢٠١", "٢١٠"), ("غرفة ٢٠١", "غرفة ٢٠٢"), ("A ٢٠١", "B 201")],
        open: &[("٢٠١", "A ٢٠١"), ("قاعة ١٦", "١٦"), ("٢٠١", "201A")],
    },
    Scheme {
        source: "Floor and room in one number (901), hotels: \
                 https://hotellogonovo.com/2021-02/reasons-why-hotel-rooms-are-numbered-in-three-digits/",
        same: &[("901", "Room 901"), ("901", "No. 901"), ("901", "Zimmer Nr. 901"), ("901", "９０１")],
        different: &[("901", "910"), ("901", "902"), ("901", "109"), ("1401", "1410")],
        open: &[("901", "901A"), ("901", "9O1"), ("901", "North 901"), ("901", "A 901")],
    },
    Scheme {
        source: "Door of a room, X if it leads outside (1219-1, 1219-X1, 1230A-2), Iowa State: \
                 https://www.scribd.com/document/514668011/123123",
        same: &[
            ("1230A-2", "1230 A-2"),
            ("1230A-2", "1230a-2"),
            ("1219-X1", "1219 X1"),
            ("1219-1", "Door 1219-1"),
        ],
        different: &[
            ("1219-1", "1219-2"),
            ("1230A-2", "1230B-2"),
            ("1219-X1", "1219-X2"),
            ("1219-1", "1291-1"),
        ],
        open: &[("1219-1", "1219"), ("1219-X1", "1219-1"), ("1230A-2", "1230-2"), ("1219-1", "1219.1")],
    },
    Scheme {
        source: "Labels of fire doors in a register (BKA-014, FD-204): \
                 https://firedoorapp.co.uk/resources/door-register-door-ids",
        same: &[
            ("BKA-014", "BKA 014"),
            ("BKA-014", "BKA014"),
            ("FD-204", "fd-204"),
            ("FD-204", "ＦＤ－２０４"),
        ],
        different: &[
            ("BKA-014", "BKB-014"),
            ("BKA-014", "BKA-041"),
            ("FD-204", "BD-204"),
            ("FD-204", "FD-240"),
        ],
        open: &[("BKA-014", "014"), ("BKA-014", "BKA-O14"), ("FD-204", "204")],
    },
    Scheme {
        source: "Kind of space and number (COR 104, STR 104, ELV 104), Wright State: \
                 http://wright.edu/facility-operations/standards-of-design/room-numbering-requirements",
        same: &[("COR 104", "COR104"), ("STR 104", "str-104"), ("ELV 201", "ＥＬＶ ２０１")],
        different: &[("COR 104", "STR 104"), ("ELV 201", "ELV 210"), ("MEC 104", "VEN 104")],
        open: &[("COR 104", "104"), ("STR 104", "STR 1O4"), ("ELV 201", "ELV 201A")],
    },
    Scheme {
        source: "Stairs with a letter, a number or a side (Stair A, Stair 2, North), fire codes: \
                 https://massconstruction.org/2022/08/13/life-safety-stair-signage/",
        same: &[
            ("Stair A", "STAIR A"),
            ("Stair 2", "stair 2"),
            ("North Stair 2", "NORTH STAIR 2"),
            ("Stair 2", "Stair No. 2"),
        ],
        different: &[
            ("Stair A", "Stair B"),
            ("Stair 1", "Stair 2"),
            ("Stair 2", "Exit 2"),
            ("North Stair 2", "South Stair 2"),
        ],
        open: &[("Stair 2", "2"), ("Stair 2", "North Stair 2"), ("Stair A2", "Stair 2")],
    },
    Scheme {
        source: "Wards with the letter of the floor (G1 to G8, F1 to F14), West Suffolk: \
                 https://www.wsh.nhs.uk/patients/staying-with-us/when-you-arrive",
        same: &[("Ward F12", "WARD F 12"), ("Ward F12", "Ward F-12"), ("Ward G8", "ward g8")],
        different: &[
            ("Ward F12", "Ward G12"),
            ("Ward F12", "Ward F2"),
            ("Ward 1", "Treatment 1"),
            ("Ward G8", "Ward G3"),
        ],
        open: &[("Ward F12", "F12"), ("Ward F12", "Ward 12"), ("Ward G8", "Ward 68")],
    },
    Scheme {
        source: "Laboratories with wing, floor and part (Lab 241B, CH-312A): \
                 https://eatsip365.com/how-to-use-a-chemistry-building-directory",
        same: &[
            ("Lab 241B", "LAB 241 B"),
            ("Lab 3.04", "lab 3.04"),
            ("CH-312A", "CH 312A"),
            ("CH-312A", "ch312-a"),
        ],
        different: &[
            ("Lab 241B", "Lab 241A"),
            ("Lab 241B", "Office 241B"),
            ("Lab 3.04", "Lab 4.03"),
            ("CH-312A", "PH-312A"),
        ],
        open: &[("Lab 241B", "241B"), ("Lab 241B", "Lab 241"), ("CH-312A", "312A"), ("Lab 3.04", "Lab 304")],
    },
    Scheme {
        source: "Level and bay, or zone and space, of a car park (P2-113, Zone A space 12): \
                 https://www.cojoasphalt.com/blog/parking-lot-numbering-systems",
        same: &[
            ("P2-113", "P 2-113"),
            ("P2-113", "p2-113"),
            ("P2-113", "Ｐ２－１１３"),
            ("Zone A space 12", "ZONE A SPACE 12"),
        ],
        different: &[
            ("P2-113", "P1-113"),
            ("P2-113", "P2-131"),
            ("P2-113", "B2-113"),
            ("Zone A space 12", "Zone B space 12"),
        ],
        open: &[
            ("P2-113", "2-113"),
            ("P2-113", "P2.113"),
            ("P2-113", "P2113"),
            ("Zone A space 12", "space 12"),
        ],
    },
    Scheme {
        source: "Halls with their sides as words (Neptune East, Neptune West), Northern Illinois: \
                 https://www.niu.edu/housing/faq/how-to-read-room-number/index.shtml",
        same: &[
            ("North 101", "NORTH 101"),
            ("Neptune East 101", "neptune east 101"),
            ("North 101", "Room North 101"),
            ("East 101", "East-101"),
        ],
        different: &[
            ("North 101", "South 101"),
            ("Neptune East 101", "Neptune West 101"),
            ("North 101", "North 110"),
            ("Neptune East 101", "Patterson East 101"),
        ],
        open: &[
            ("North 101", "101"),
            ("North 101", "N 101"),
            ("Neptune East 101", "Neptune 101"),
            ("East 101", "Neptune East 101"),
        ],
    },
    Scheme {
        source: "Staircase and door, with slashes for short (Stiege 2 Tür 19, 53/2/19, Tür 15A), Vienna: \
                 https://wien.gv.at/wohnen/baupolizei/planen/richtlinien/nutzungseinheitennum.html",
        same: &[
            ("Stiege 2 Tür 19", "STIEGE 2 TÜR 19"),
            ("Tür 15A", "Tür 15 A"),
            ("53/2/19", "５３／２／１９"),
            ("Tür 15A", "15a"),
        ],
        different: &[
            ("Stiege 2 Tür 19", "Stiege 1 Tür 19"),
            ("Tür 15A", "Tür 15B"),
            ("53/2/19", "53/1/19"),
            ("Stiege 2 Tür 19", "Stiege 2 Tür 91"),
        ],
        open: &[
            ("Tür 15", "Tür 15A"),
            ("Stiege 2 Tür 19", "Tür 19"),
            ("53/2/19", "2/19"),
            ("53/2/19", "53-2-19"),
        ],
    },
    Scheme {
        source: "Residence, staircase and floor, letter of the room (DEC055D, DEC131A), Brock: \
                 https://brocku.ca/housing/bedroom-name-decoder",
        same: &[("DEC055D", "DEC 055D"), ("DEC055D", "DEC 055 D"), ("DEC055D", "dec-055-d")],
        different: &[
            ("DEC055D", "DEC055C"),
            ("DEC055D", "DEC045D"),
            ("DEC055D", "VAL055D"),
            ("DEC131A", "DEC131B"),
        ],
        open: &[("DEC055D", "DEC055"), ("DEC055D", "055D"), ("DEC 055D", "DEC O55D")],
    },
];
