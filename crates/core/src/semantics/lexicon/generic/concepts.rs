//! Concepts of signs, after the names of ISO 7010 and ISO 7001, with their words in the languages that buildings use.
//!
//! A `_` joins the words of a phrase that mean other things alone.

use self::Reading::{Drawn, Plain};

/// Ways in which a word of a concept is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// It stands beside a pictogram or an arrow, and may be misread.
    Drawn,
    /// As written: too near to other words and to names.
    Plain,
}

/// Words and names that are one character away from a generic word.
pub const OTHERS: &str = "abmeldung apunto ascenso assembla assemble aufgang aushang auszug auxilia banheira blesser \
    blosser brauchen busser bygning centrada centry decepcio decepcion deception elevado emergente \
    empang entrante entre entren entrer entrez escalar escama escapa escarpe escola escole espada \
    estada estrada estree evacuate evaluacion evaluatie evaluation exito extinto froken fulare \
    fureur gentry hydrate informal informatic informatif informatik informativ informative inging \
    ingreso ingress insang korit kroken lavado lavato neuvosta nodfall occorso palencia portaal \
    portant portrait raccolto racconta rachen raucher rauschen recepte receptive regning reunido \
    reunir ritroso sagitario salada salda saliba salid saliha salima salina salita saliva saluda \
    sanitary savida sayida scalar scaled scour secouer segara sejour sentry servito servizio sigari \
    sigaro smoker smokey solida sorrida sorte sorti sortir sortira stackare strappa suscita tanga \
    tangka tappe tappen toile trampa trampe trapped trapper trempe trippa troppa troppen truppa \
    truppen udang umgang useita utang yagin yangon εφοδοσ υποδομη аптека западнои западныи купить";

/// By the concepts of ISO 7010 (safety signs) and ISO 7001 (public information symbols). Words in their normal form;
/// `_` joins words that are generic only together.
pub const CONCEPTS: &[(&str, Reading, &str)] = &[
    (
        "exit",
        Drawn,
        "exit salida sortie ausgang uscita saida uitgang sortida wyjscie vychod vystup utgang \
         udgang uloskaynti cikis εξοδοσ выход مخرج خروج الخروج יציאה יציאת निकास 出口 出口処 출구 나가는곳 \
         ทางออก loi_ra keluar pintu_keluar",
    ),
    (
        "emergency",
        Drawn,
        "emergency emergencia secour notausgang notfall fluchtweg rettungsweg emergenza \
         nooduitgang nood nooduit vluchtweg awaryjne ewakuacyjne ewakuacja nouzovy unikovy \
         nodutgang nodutrymning nødudgang nødutgang hatapoistumistie hatauloskaynti \
         varauloskaynti acil κινδυνου εκτακτησ αναγκησ аварииныи запасныи запаснои эвакуационныи \
         эвакуация طوارئ الطوارئ النجاة חירום आपातकालीन आपात 非常口 避難口 紧急出口 緊急出口 安全出口 疏散出口 非常出口 紧急 \
         緊急 疏散 避難 비상구 비상 ฉุกเฉิน ทางออกฉุกเฉิน thoat_hiem loi_thoat_hiem darurat evacuation \
         evacuacion evacuazione evacuacao evacuatie evacuacio escape",
    ),
    (
        "entrance",
        Drawn,
        "entrance entry entrada entree eingang ingresso ingang wejscie vchod indgang inngang \
         sisaankaynti giris εισοδοσ вход مدخل دخول الدخول כניסה प्रवेश 入口 入口処 진입 입구 ทางเข้า \
         loi_vao masuk pintu_masuk",
    ),
    (
        "stairs",
        Drawn,
        "stair staircase stairway stairwell escalera escalier treppe treppen treppenhaus scala \
         scale escada trap trappen escala escale schody schodiste trappa trapp trappe portaat \
         porrastie merdiven merdivenler σκαλα σκαλεσ κλιμακοστασιο лестница سلم درج الدرج السلالم \
         מדרגות सीढ़ी सीढ़ियाँ 楼梯 樓梯 階段 扶梯 계단 บันได cau_thang tangga",
    ),
    (
        "lift",
        Drawn,
        "lift elevator ascensor ascensore ascenseur aufzug fahrstuhl elevador elevadore winda \
         vytah hiss heis hissi asansor ανελκυστηρασ ασανσερ лифт مصعد المصعد מעלית लिफ्ट लिफ़्ट \
         电梯 電梯 升降機 升降机 直梯 エレベーター エレベータ 엘리베이터 승강기 ลิฟต์ thang_may",
    ),
    (
        "escalator",
        Plain,
        "escalator rolltreppe roltrap ruchome eskalator rulltrappa rulletrappe liukuportaat \
         эскалатор 自动扶梯 自動扶梯 手扶梯 手扶電梯 エスカレーター 에스컬레이터 บันไดเลื่อน thang_cuon",
    ),
    (
        "toilet",
        Drawn,
        "toilet restroom washroom lavatory bathroom wc aseo bano servicio lavabo toilette \
         toiletten bagno bagni servizi banheiro sanitario toaleta toalety zachod toalett \
         toaletter wc-tilat tuvalet τουαλετα τουαλετεσ туалет دورة_مياه حمام مرحاض שירותים शौचालय \
         厕所 廁所 卫生间 衛生間 洗手间 洗手間 化妝室 盥洗室 お手洗い お手洗 手洗い 便所 トイレ 化粧室 화장실 ห้องน้ํา สุขา nha_ve_sinh \
         kamar_kecil",
    ),
    (
        "men",
        Plain,
        "men 男 man gent gentlemen male hombre caballero homme messieur herren herr uomini uomo \
         homen heren home meski meska panowie muzi pani herrar herrer mænd menn miehet erkek \
         erkekler baylar ανδρων ανδρεσ мужскои мужская мужчины رجال للرجال גברים पुरुष 男士 男性 男子 \
         男厕 男廁 先生 紳士 남자 남성 ชาย pria",
    ),
    (
        "women",
        Plain,
        "women 女 woman ladie lady female mujere mujer senora dama femme dame damen frauen donne \
         senhora mulhere vrouwen done damski damska panie zeny damy damer kvinnor kvinder kvinner \
         naiset kadin kadinlar bayan bayanlar γυναικων γυναικεσ женскии женская женщины نساء \
         سيدات للنساء للسيدات נשים महिला महिलाएँ 女士 女性 女子 女厕 女廁 婦人 여자 여성 หญิง wanita",
    ),
    (
        "push",
        Plain,
        "push empujar empuje poussez pousser drucken stossen spingere empurre empurrar duwen \
         empenyeu empenyer pchac tlacit tryck tryk skubh trykk skyv tyonna itiniz ωθησατε от_себя \
         ادفع دفع דחוף לדחוף धक्का 推 押 押す 推开 推開 미시오 미세요 ผลัก đay dorong",
    ),
    (
        "pull",
        Plain,
        "pull tirar tire jalar jale tirez tirer ziehen tirare puxe puxar trekken estireu estirar \
         ciagnac tahnout drag træk trekk veda cekiniz ελξατε на_себя اسحب سحب משוך למשוך खींचें 拉 \
         引 引く 拉开 拉開 당기시오 당기세요 ดึง tarik",
    ),
    (
        "smoking",
        Drawn,
        "smoking smoke fumar fumer fumeur rauchen rauchverbot fumare fumo roken palenie palic \
         palenia koureni kourit rokning rokfritt rygning røyking tupakointi sigara icilmez \
         καπνισμα καπνιζετε курить курения التدخين عشان לעשן עישון धूम्रपान 吸烟 吸煙 抽烟 禁煙 禁烟 喫煙 \
         禁止吸烟 禁止吸煙 請勿吸煙 请勿吸烟 금연 흡연 สูบบุหรี่ hut_thuoc merokok",
    ),
    (
        "no entry",
        Plain,
        "defense zutritt betreten accesso toegang wstep wstepu vstup vstupu tilltrade obehoriga \
         adgang paasy girilmez посторонним מנע 进入 進入 入内 禁止入内 禁止进入 禁止進入 通行 출입금지 출입 ห้ามเข้า \
         cam_vao cam_hut_thuoc",
    ),
    (
        "fire extinguisher",
        Drawn,
        "extinguisher extintor extintore extincteur feuerloscher estintore estintori brandblusser \
         blusser gasnica hasici pristroj brandslackare slackare ildslukker brannslukker \
         brannslukkingsapparat sammutin kasisammutin jauhesammutin sondurucu sondurme yangin tupu \
         πυροσβεστηρασ огнетушитель مطفأة طفاية حريق الحريق מטף अग्निशामक 灭火器 滅火器 消火器 소화기 \
         ถังดับเพลิง เครื่องดับเพลิง binh_chua_chay pemadam apar",
    ),
    (
        "fire hose",
        Plain,
        "hydrant hose boca_de_incendio manguera incendio incendie hydrante wandhydrant \
         loschschlauch loschwasser idrante idranti antincendio mangueira hidrante brandslang \
         brandhaspel manega hydrantowy hydrantovy brandpost slanghylla brandslange brannslange \
         paloposti yangin_dolabi πυροσβεστικη φωλια пожарныи гидрант خرطوم הידרנט ברז_כיבוי 消火栓 \
         消防栓 室内消火栓 屋内消火栓 消防 灭火 소화전 สายดับเพลิง voi_chua_chay hidran",
    ),
    (
        "fire alarm",
        Plain,
        "alarm alarma alarme feuermelder feueralarm brandmelder brandmeldeanlage allarme \
         brandmeldung brandalarm pozar pozarowy pozarni brandlarm brandvarnare branddetektor \
         palohalytin paloilmoitin palovaroitin alarmi ihbar συναγερμοσ тревога пожарная إنذار \
         אזעקה אש अलार्म 火警 火灾报警 火警警報 警報 報警 报警 火災報知機 火災報知器 非常ベル 発信機 화재경보기 경보 สัญญาณเตือนภัย \
         แจ้งเหตุเพลิงไหม้ chuong_bao_chay bao_chay kebakaran",
    ),
    (
        "first aid",
        Drawn,
        "aid defibrillator aed dae botiquin auxilio defibrilador desfibrilador defibrillateur \
         infirmerie verbandkasten verbandskasten defibrillatore soccorso socorro ehbo auxilis \
         apteczka pierwsza_pomoc pierwszej_pomocy lekarnicka prvni_pomoc hjartstartare \
         hjertestarter ensiapu defibrillaattori ilkyardim πρωτεσ_βοηθειεσ аптечка дефибриллятор \
         إسعافات أولية עזרה_ראשונה प्राथमिक_चिकित्सा 急救 急救箱 救護 救急 救急箱 응급처치 구급함 자동심장충격기 ปฐมพยาบาล \
         so_cuu pertolongan_pertama",
    ),
    (
        "assembly point",
        Drawn,
        "assembly encuentro reunion rassemblement sammelplatz sammelstelle raccolta ritrovo punto \
         verzamelplaat verzamelpunt reunio zbiorka zbiorki shromazdiste atersamlingsplat \
         uppsamlingsplat samlingsplad samleplass møteplass kokoontumispaikka toplanma \
         συγκεντρωσησ сбора تجمع نقطة_تجمع התכנסות מפגש एकत्रीकरण 集合点 集合點 集合場所 避難場所 避難所 대피소 집결지 \
         จุดรวมพล tap_ket titik_kumpul",
    ),
    (
        "information",
        Drawn,
        "information info informacion auskunft informationen informazioni informacao informacoe \
         informatie inlichtingen informacio informacja informacje informace opplysning neuvonta \
         infopiste danisma πληροφοριεσ информация справочная استعلامات معلومات מידע מודיעין सूचना \
         जानकारी 咨询处 詢問處 问讯处 服务台 服務台 信息 案内 案内所 ご案内 안내 안내소 ประชาสัมพันธ์ สอบถาม thong_tin \
         informasi",
    ),
    (
        "reception",
        Drawn,
        "reception recepcion empfang rezeption anmeldung receptie recepcio recepcja recepce \
         receptionen resepsjon vastaanotto resepsiyon ρεσεψιον υποδοχη ресепшн ресепшен приемная \
         استقبال الاستقبال קבלה स्वागत 接待处 接待處 前台 总台 受付 접수 리셉션 ต้อนรับ le_tan resepsionis",
    ),
    (
        "danger",
        Plain,
        "danger warning caution attention peligro peligroso atencion precaucion cuidado \
         avertissement gefahr vorsicht achtung warnung lebensgefahr pericolo attenzione \
         pericoloso perigo atencao gevaar waarschuwing oppassen perill atencio uwaga \
         niebezpieczenstwo ostroznie pozor nebezpeci vystraha varning livsfara advarsel forsigtig \
         livsfare forsiktig vaara varoitus huomio hengenvaara tehlike dikkat uyari κινδυνοσ \
         προσοχη опасно опасность внимание осторожно خطر تحذير احترس انتباه סכנה זהירות אזהרה \
         खतरा सावधान चेतावनी 危险 危險 小心 注意 警告 当心 當心 当心触电 危険 足元注意 頭上注意 위험 주의 경고 อันตราย ระวัง \
         คําเตือน nguy_hiem chu_y canh_bao bahaya awa perhatian",
    ),
    (
        "high voltage",
        Plain,
        "voltage tension hochspannung spannung tensione tensao hoogspanning tensio napiecie \
         napeti hogspanning højspænding høyspenning hengenvaarallinen jannite gerilim ταση \
         напряжение الجهد חשמל 高压 高壓 有电 有電 高電圧 感電注意 고전압 ไฟฟ้าแรงสูง đien_cao_ap tegangan",
    ),
    (
        "please",
        Plain,
        "please favor porfavor plait svp bitte favore alstublieft aub prosim prosze vanligen \
         venligst vennligst lutfen παρακαλω παρακαλουμε пожалуиста الرجاء يرجى فضلك בבקשה נא \
         कृपया 请 請 ください 下さい お願いします 주세요 마세요 โปรด กรุณา xin_vui_long vui_long harap mohon",
    ),
    (
        "keep clear",
        Plain,
        "keep clear freihalten obstruir obstruya aparcar estacionar libre stationner encombrer \
         parcheggiare ostruire ingombrare vrijhouden vrijlaten parkeren zastawiac zastavovat \
         blokera blockera blokere sperre parkering esta kapatmayiniz παρκαρετε загораживать \
         парковаться الوقوف לחסום לחנות 保持畅通 保持暢通 禁止停车 禁止停車 駐車禁止 駐車ご遠慮ください 주차금지 ห้ามจอด cam_đo_xe \
         parkir",
    ),
    (
        "closed",
        Plain,
        "closed open opened cerrado cerrada abierto abierta ferme fermee ouvert ouverte \
         geschlossen geoffnet chiuso chiusa aperto aperta fechado aberto gesloten geopend tancat \
         obert zamkniete otwarte zavreno otevreno stangt oppet lukket abent stengt apent suljettu \
         avoinna kapali acik κλειστο ανοικτο ανοιχτο закрыто открыто مغلق مفتوح סגור פתוח बंद \
         खुला 关闭 關閉 开门 营业中 營業中 営業中 準備中 閉店 닫힘 열림 영업중 ปิด เปิด đong_cua mo_cua tutup buka",
    ),
    (
        "private",
        Plain,
        "private privado privada prive privee privat privato reservado particular prywatne \
         soukrome yksityinen ozel ιδιωτικο ιδιωτικοσ служебное частная خاص פרטי निजी 闲人免进 閒人免進 \
         員工專用 员工专用 関係者以外 関係者以外立入禁止 관계자외 직원전용 เฉพาะเจ้าหน้าที่ danh_cho_nhan_vien khusus_karyawan",
    ),
    (
        "staff",
        Plain,
        "staff personnel personal mitarbeiter personale pessoal personeel personał pracownicy \
         zamestnanci ansatte henkilokunta personel προσωπικο персонал موظفين עובדים कर्मचारी 员工 \
         員工 工作人员 職員 スタッフ 직원 เจ้าหน้าที่ nhan_vien karyawan",
    ),
    (
        "silence",
        Plain,
        "silence quiet silencio ruhe stille silenzio stilte silenci cisza ticho tystnad stilhed \
         stillhet hiljaisuus sessiz sessizlik ησυχια тишина тихо هدوء الهدوء שקט शांति 安静 安靜 肃静 \
         肅靜 静かに お静かに 정숙 조용히 เงียบ giu_im_lang im_lang tenang",
    ),
];
